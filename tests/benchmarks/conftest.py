"""What the tests share: the scripts of the peers, one thread, a coarse mesh of each problem."""

import json
import sys
from pathlib import Path

import pytest
from ngsolve import GetNumThreads, SetNumThreads

sys.path.insert(0, str(Path(__file__).parent / "peers"))

import meshes
from peercommand import Main

COARSE = {"hertz": 3.0, "sphere": 4.0, "patch": 1 / 3}


@pytest.fixture(scope="module", autouse=True)
def _one_thread():
    """The problems here are so small that a second one only waits."""
    before = GetNumThreads()
    SetNumThreads(1)
    yield
    SetNumThreads(before)


@pytest.fixture(scope="session")
def files(tmp_path_factory):
    """Of the meshes of the comparison."""
    folder = tmp_path_factory.mktemp("meshes")
    names = {problem: folder / f"{problem}_{h:g}.npz" for problem, h in COARSE.items()}
    for problem, file in names.items():
        meshes.Make(problem, COARSE[problem], file)
    return names


@pytest.fixture(params=COARSE)
def mesh(request, files):
    """A `PeerMesh` of each problem."""
    return meshes.Load(files[request.param])


@pytest.fixture
def drive(files, tmp_path):
    """Run a driver in this process; its exit code, and the row that it wrote, if any."""

    def Run(driver, problem, *more):
        file = tmp_path / "row.json"
        line = [problem, str(files[problem]), "--json", str(file), *more]
        code = Main(driver.Solve, peer="peer", options=driver.Options, argv=line)
        return code, json.loads(file.read_text()) if file.exists() else None

    return Run
