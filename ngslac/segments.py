"""The segments of a pairing as numpy arrays, for pictures and for ParaView."""

from pathlib import Path

import numpy as np

__all__ = ["Segments"]

VTK_LINE, VTK_QUAD = 3, 9


class Segments:
    """What a pairing consists of: parts of slave faces, each facing one master face.

    Attributes
    ----------
    slave, master : (n,) int
        Boundary element numbers; master -1 for an obstacle.
    area, gap : (n,)
        Slave area and its mean gap along the slave normal (> 0 open).
    slave_points, master_points : (n, 2, d)
        End points on both sides; a line from each to its partner is a slave normal.
    """

    def __init__(self, form, dim):
        data = form.SegmentData().reshape(form.nsegments, -1)
        self.slave, self.master = data[:, 0].astype(int), data[:, 1].astype(int)
        self.area, self.gap = data[:, 2], data[:, 3]
        corners = data[:, 4:].reshape(form.nsegments, -1, 2, dim)
        self.slave_points, self.master_points = corners[:, :, 0], corners[:, :, 1]

    def __len__(self):
        return len(self.slave)

    def WriteVTU(self, filename):
        """Write the segments as quadrilaterals from slave to master for ParaView; returns the path.

        Cell data: slave, master, area, gap.
        """
        path = Path(filename)
        if path.suffix != ".vtu":
            path = path.with_name(path.name + ".vtu")
        quads = np.stack(
            [
                self.slave_points[:, 0],
                self.slave_points[:, 1],
                self.master_points[:, 1],
                self.master_points[:, 0],
            ],
            axis=1,
        )
        points = np.zeros((4 * len(self), 3))
        points[:, : quads.shape[2]] = quads.reshape(len(points), -1)
        cells = np.arange(len(points)).reshape(-1, 4)
        arrays = {"slave": self.slave, "master": self.master, "area": self.area, "gap": self.gap}
        path.write_text(VTUText(points, cells, VTK_QUAD, arrays))
        return path

    def _GetWebguiData(self):
        lines = np.zeros((2 * len(self), 2, 3))
        dim = self.slave_points.shape[2]
        lines[:, 0, :dim] = self.slave_points.reshape(-1, dim)
        lines[:, 1, :dim] = self.master_points.reshape(-1, dim)
        return {
            "type": "lines",
            "name": "contact segments",
            "color": "black",
            "position": lines.ravel().tolist(),
        }


def VTUText(points, cells, celltype, cell_data):
    """An unstructured VTK grid as XML text."""

    def Array(values, name, kind, components=1):
        text = " ".join(map(repr, np.asarray(values).ravel().tolist()))
        return (
            f'<DataArray type="{kind}" Name="{name}" NumberOfComponents="{components}" '
            f'format="ascii">{text}</DataArray>'
        )

    ncells, npoints = cells.shape
    kinds = {"i": "Int64", "f": "Float64"}
    data = "".join(Array(v, k, kinds[np.asarray(v).dtype.kind]) for k, v in cell_data.items())
    return (
        '<VTKFile type="UnstructuredGrid" version="0.1"><UnstructuredGrid>'
        f'<Piece NumberOfPoints="{len(points)}" NumberOfCells="{ncells}">'
        f"<Points>{Array(points, 'points', 'Float64', 3)}</Points>"
        f"<Cells>{Array(cells, 'connectivity', 'Int64')}"
        f"{Array(npoints * np.arange(1, ncells + 1), 'offsets', 'Int64')}"
        f"{Array(np.full(ncells, celltype), 'types', 'Int64')}</Cells>"
        f"<CellData>{data}</CellData></Piece></UnstructuredGrid></VTKFile>\n"
    )
