# SPDX-License-Identifier: LGPL-2.1-or-later
"""The scaled matrix of bulk and contacts, changed where contacts change."""

import numpy as np

from ngslac._ngslac import MergeMatrices
from ngslac.arrays import SameEntries

__all__ = ["Merged"]


class Merged:
    """A merged matrix that serves for the next systems with the same bulk.

    Attributes
    ----------
    mat : BaseMatrix or None
    """

    def __init__(self):
        self.Forget()

    def Forget(self):
        """Make another matrix the next time, as where the bulk has got other values."""
        self.mat = self._bulk = self._scale = self._contacts = None

    def Update(self, bulk, contacts, scale):
        """Make `mat` that of these matrices; False if it was so before, to the last bit."""
        mat, same = self.mat, bulk is self._bulk and np.array_equal(scale, self._scale)
        entries = [[np.array(part) for part in contact.CSR()] for contact in contacts]
        if same and SameEntries(entries, self._contacts):
            return False
        self.Forget()  # half changed, if that raises an error
        self.mat = MergeMatrices(bulk, contacts, scale, mat if same else None)
        self._bulk, self._scale, self._contacts = bulk, np.array(scale), entries
        return True
