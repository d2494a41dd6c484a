"""How fast gaps change by functions of their own: obstacles and offsets with a Parameter."""

import numpy as np

__all__ = ["Obstacles"]


class Obstacles:
    """How fast obstacles and offsets open the mean gaps, from what they did in the last steps.

    Parameters
    ----------
    contacts : list[LACContact]
        With a master in place of an obstacle, and no offset, the rates are zero.
    """

    def __init__(self, contacts):
        self.contacts = contacts
        self.state = None  # rates of the last step, of all macro-elements, and its length
        self._before, self.opening = None, None

    def Begin(self, gf):
        """Before the time is set to the end of the step; `gf` is where the step begins."""
        self._before = self._Gaps(gf)

    def Move(self, gf):
        """After that; `gf` is the same. `opening`: change of each mean gap by its obstacle."""
        after = self._Gaps(gf)
        self.opening = [b - a for a, b in zip(self._before, after, strict=True)]

    def _Gaps(self, gf):
        return [self._Of(contact, gf) for contact in self.contacts]

    def _Of(self, contact, gf):
        if not contact.gap_is_driven:
            return np.zeros(contact.space.nmacros)
        contact.Evaluate(gf)
        return contact.Table()["gap"].copy()

    def Rates(self, dt):
        """Rates at the end of a step of the length `dt`, from backward differences."""
        rates = np.concatenate(self.opening) / dt
        before, last = self.state or (rates, dt)
        if len(before) != len(rates):  # the mesh was refined
            before = rates
        self.state = rates, dt
        rates = rates + dt / (dt + last) * (rates - before)
        return np.split(rates, np.cumsum([len(part) for part in self.opening])[:-1])

    def Work(self):
        """Of the moved obstacles on the bodies, after `Evaluate` at the end of the step."""
        return sum(map(self._WorkOf, self.contacts, self.opening))

    def _WorkOf(self, contact, opening):
        if not np.any(opening):
            return 0.0
        table = contact.Table()
        pressure = -np.sum(table["traction"] * table["normal"], axis=1)
        return -float((table["area"] * pressure) @ opening)
