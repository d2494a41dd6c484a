# SPDX-License-Identifier: LGPL-2.1-or-later
"""The segments of a pairing as numpy arrays, for pictures and for ParaView."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ngslac.files import Replacing
from ngslac.output.vtkfile import VTUPath

if TYPE_CHECKING:
    from ngslac._ngslac import ContactForm

__all__ = ["Segments"]

VTK_POLYGON, VTK_QUAD = 7, 9


class Segments:
    """The segments of a pairing: parts of slave faces, each facing one master face.

    Attributes
    ----------
    slave, master : (n,) int
        Boundary element numbers; master -1 for an obstacle.
    area, gap : (n,)
        Slave area and its mean gap along the slave normal (> 0 open).
    slave_points, master_points : (n, 2, 2) in 2D, (m, 3) in 3D
        Corners on both sides, end points in 2D; a line from each to its partner is a slave normal.
    first : (n + 1,) int
        In 3D the corners of segment i are the rows ``first[i]`` to ``first[i + 1]``.
    """

    def __init__(self, form: ContactForm, dim: int):
        values, corners, first = form.Segments()
        self.first = first.astype(int)
        values = values.reshape(form.nsegments, 4)
        self.slave, self.master = values[:, 0].astype(int), values[:, 1].astype(int)
        self.area, self.gap = values[:, 2], values[:, 3]
        corners = corners.reshape(-1, 2, dim)
        self.slave_points, self.master_points = corners[:, 0], corners[:, 1]
        if dim == 2:
            self.slave_points = self.slave_points.reshape(-1, 2, 2)
            self.master_points = self.master_points.reshape(-1, 2, 2)

    def __repr__(self) -> str:
        return f"<Segments: {len(self)} with the area {self.area.sum():g}>"

    def __len__(self) -> int:
        return len(self.slave)

    def WriteVTU(self, filename: str | Path) -> Path:
        """Write the segments for ParaView.

        2D: quadrilaterals from slave to master. 3D: the polygons on the slave and then those on the
        master. Cell data: slave, master, area, gap, and in 3D side (1 slave, 2 master).

        Parameters
        ----------
        filename : str or Path
            The ending .vtu is added where it is missing.

        Returns
        -------
        pathlib.Path

        Raises
        ------
        OSError
            The file cannot be written; nothing is left of it.
        """
        path = VTUPath(filename)
        arrays = {"slave": self.slave, "master": self.master, "area": self.area, "gap": self.gap}
        if self.slave_points.ndim == 3:
            quads = np.concatenate([self.slave_points, self.master_points[:, ::-1]], axis=1)
            points = np.pad(quads.reshape(-1, 2), ((0, 0), (0, 1)))
            return Write(path, VTUText(points, 4 * np.arange(1, len(self) + 1), VTK_QUAD, arrays))
        points = np.concatenate([self.slave_points, self.master_points])
        ends = np.concatenate([self.first[1:], self.first[-1] + self.first[1:]])
        arrays = {name: np.tile(values, 2) for name, values in arrays.items()}
        arrays["side"] = np.repeat([1, 2], len(self))
        return Write(path, VTUText(points, ends, VTK_POLYGON, arrays))

    def _GetWebguiData(self) -> dict[str, Any]:
        """Return lines for the webgui."""
        if self.slave_points.ndim == 3:
            lines = np.stack([self.slave_points, self.master_points], axis=2)
            lines = np.pad(lines.reshape(-1, 2, 2), ((0, 0), (0, 0), (0, 1)))
        else:
            lines = self._Outlines()
        return {
            "type": "lines",
            "name": "contact segments",
            "color": "black",
            "position": lines.ravel().tolist(),
        }

    def _Outlines(self) -> np.ndarray:
        """Sides of the polygons on the slave, and a line from slave to master in the middle."""
        following = np.arange(1, len(self.slave_points) + 1)
        following[self.first[1:] - 1] = self.first[:-1]
        sides = np.stack([self.slave_points, self.slave_points[following]], axis=1)
        counts = np.diff(self.first)[:, None]
        middle = [
            np.add.reduceat(points, self.first[:-1], axis=0) / counts
            for points in (self.slave_points, self.master_points)
        ]
        return np.concatenate([sides, np.stack(middle, axis=1)])


def Write(path: Path, text: str) -> Path:
    with Replacing(path) as part:
        part.write_text(text)
    return path


def VTUText(
    points: np.ndarray, ends: np.ndarray, celltype: int, cell_data: dict[str, np.ndarray]
) -> str:
    """An unstructured VTK grid of cells with points of their own, as XML text.

    Cell i has the points from ``ends[i - 1]`` to ``ends[i]``.
    """

    def Array(values: np.ndarray, name: str, kind: str, components: int = 1) -> str:
        text = " ".join(map(repr, np.asarray(values).ravel().tolist()))
        return (
            f'<DataArray type="{kind}" Name="{name}" NumberOfComponents="{components}" '
            f'format="ascii">{text}</DataArray>'
        )

    kinds = {"i": "Int64", "f": "Float64"}
    data = "".join(Array(v, k, kinds[np.asarray(v).dtype.kind]) for k, v in cell_data.items())
    return (
        '<VTKFile type="UnstructuredGrid" version="0.1"><UnstructuredGrid>'
        f'<Piece NumberOfPoints="{len(points)}" NumberOfCells="{len(ends)}">'
        f"<Points>{Array(points, 'points', 'Float64', 3)}</Points>"
        f"<Cells>{Array(np.arange(len(points)), 'connectivity', 'Int64')}"
        f"{Array(ends, 'offsets', 'Int64')}"
        f"{Array(np.full(len(ends), celltype), 'types', 'Int64')}</Cells>"
        f"<CellData>{data}</CellData></Piece></UnstructuredGrid></VTKFile>\n"
    )
