"""What a contact computation gives besides fields: tables, resultants, operators, reports."""

import numpy as np

from ngslac._ngslac import Side
from ngslac.arguments import CheckPoint
from ngslac.contact.report import ContactReport
from ngslac.output.segments import Segments

__all__ = ["ContactResults"]


class ContactResults:
    """Results of a contact, from its compiled `form` on its `mesh`: the base of `LACContact`."""

    def _PairOnce(self):
        if self.form.paired:
            self.form.CheckPaired()
        else:
            self.Update()

    def Table(self):
        """The last evaluation as numpy arrays over the macro-elements.

        Returns
        -------
        dict
            ``x`` (n, d) centroid, ``normal`` (n, d), ``area`` (n) paired, ``fullarea`` (n),
            both of the reference configuration with ``finite=True``,
            ``pressure`` (n), ``traction`` (n, d) on the slave, ``gap`` (n) > 0 open,
            ``slip`` (n, d) of the last step, ``status`` (n) 0 open, 1 stick, 2 slip,
            ``friction`` (n) coefficient, -1 without Coulomb friction.
        """
        d = self.mesh.dim
        states = self.form.States().reshape(-1, 9)
        table = {name: self.form.Scalars(name) for name in ("area", "fullarea", "friction")}
        return table | {
            "x": self.form.Vectors("center").reshape(-1, d),
            "normal": self.form.Vectors("normal").reshape(-1, d),
            "pressure": states[:, 0],
            "gap": states[:, 1],
            "status": states[:, 2].astype(int),
            "traction": states[:, 3 : 3 + d],
            "slip": states[:, 6 : 6 + d],
        }

    def Force(self):
        """Resultant (d,) of the contact tractions on the slave; the master gets the opposite."""
        return self.form.Vectors("force").reshape(-1, self.mesh.dim).sum(axis=0)

    def Moment(self, point=None):
        """Moment of the contact tractions on the slave.

        Parameters
        ----------
        point : (d,) array-like, optional
            About which; a position (length). Default: the origin.

        Returns
        -------
        float in 2D, (3,) array in 3D
            Force times length.

        Raises
        ------
        ValueError
            A point of another dimension.
        """
        d = self.mesh.dim
        point = np.zeros(d) if point is None else CheckPoint("point", point, d)
        total = self.form.Vectors("moment").reshape(-1, 3).sum(axis=0)
        arm, force = np.zeros(3), np.zeros(3)
        arm[:d], force[:d] = point, self.Force()
        moment = total - np.cross(arm, force)
        return float(moment[2]) if d == 2 else moment

    def Mortar(self):
        """Operators D and M of the weighted mean jump, as NGSolve sparse matrices.

        ``D u - M u`` is the integral of (slave minus paired master displacement) over each
        macro-element, d rows per macro-element, columns the dofs of the displacement space. For
        scipy copy the arrays of ``D.CSR()``: they are views that die with the matrix.
        """
        self._PairOnce()
        return self.form.JumpMatrix(Side.slave), self.form.JumpMatrix(Side.master)

    def Segments(self):
        """The segments of the pairing, see `Segments`."""
        self._PairOnce()
        return Segments(self.form, self.mesh.dim)

    def Check(self):
        """A readable report of the pairing, see `ContactReport`."""
        self._PairOnce()
        return ContactReport(self)

    def _GetWebguiData(self):
        return self.Segments()._GetWebguiData()
