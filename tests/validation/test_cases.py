"""Every reference case holds, computed with small sizes and without its picture."""

import pytest
from cases import CASES


def Marked(case):
    marks = [pytest.mark.slow] if case.slow else []
    return pytest.param(case, id=case.name, marks=marks)


@pytest.mark.parametrize("case", [Marked(case) for case in CASES.values()])
def test_every_judged_row_holds(case):
    rows = case.function(quick=True).rows
    assert [row.Cells() for row in rows if not row.holds] == []
    assert any(row.judged for row in rows)
