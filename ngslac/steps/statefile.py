# SPDX-License-Identifier: LGPL-2.1-or-later
"""A file of numbers, text and arrays with a check sum, from which no code can run."""

import hashlib
import json
from collections.abc import Sequence
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import IO, Any

import numpy as np

from ngslac.files import Replacing

__all__ = ["ReadTree", "WriteTree"]

MAGIC = b"ngslac state 2\n"
PICKLE = b"\x80"  # what files of older versions begin with
CHUNK = 1 << 20


def WriteTree(path: Path, tree: Any, records: Sequence[type] = ()) -> None:
    """Write dicts, lists, tuples, numbers, strings, bytes and arrays, in each other, to a file."""
    arrays = []
    encoded = Encoded(tree, arrays, tuple(records))
    text = json.dumps({"tree": encoded, "arrays": len(arrays)}).encode()
    with Replacing(path) as part, open(part, "wb") as file:
        stream = Summing(file)
        stream.write(MAGIC + len(text).to_bytes(8, "little") + text)
        for array in arrays:
            np.lib.format.write_array(stream, array, allow_pickle=False)
        file.write(stream.digest())


def ReadTree(path: Path, records: Sequence[type] = ()) -> Any:
    """Read a file of `WriteTree`."""
    if path.exists() and not path.is_file():
        raise OSError(f"{path} is no regular file")
    with open(path, "rb") as file:
        CheckSum(path, file)
        file.seek(len(MAGIC))
        found = json.loads(file.read(int.from_bytes(file.read(8), "little")))
        count = range(found["arrays"])
        arrays = [np.lib.format.read_array(file, allow_pickle=False) for _ in count]
    return Decoded(found["tree"], arrays, {record.__name__: record for record in records})


class Summing:
    """A stream that sums up what it writes."""

    def __init__(self, file: IO[bytes]):
        self._file, self._sum = file, hashlib.sha256()
        self.digest = self._sum.digest

    def write(self, data: bytes) -> int:
        self._sum.update(data)
        return self._file.write(data)


def CheckSum(path: Path, file: IO[bytes]) -> None:
    """Refuse a file that differs in any bit from the one that was written."""
    begin = file.read(len(MAGIC))
    if begin[:1] == PICKLE:
        raise ValueError(
            f"{path} is a pickle, as earlier versions of ngslac wrote them: reading one can run "
            "any code, save the state anew with this version"
        )
    if begin != MAGIC:
        raise ValueError(f"{path} was not written by SaveState of this version of ngslac")
    found, before = hashlib.sha256(begin), b""
    while chunk := file.read(CHUNK):
        # The last bytes are the sum itself.
        data = before + chunk
        found.update(data[: -found.digest_size])
        before = data[-found.digest_size :]
    if before != found.digest():
        raise ValueError(f"{path} is damaged: its check sum is wrong; take another copy of it")


# --- values --------------------------------------------------------------------------------------


def Encoded(value: Any, arrays: list, records: tuple[type, ...]) -> Any:
    """A tree that JSON can hold; arrays are appended to the list."""

    def Inside(part: Any) -> Any:
        return Encoded(part, arrays, records)

    if isinstance(value, (np.ndarray, bytes)):
        kind = "array" if isinstance(value, np.ndarray) else "bytes"
        arrays.append(np.frombuffer(value, np.uint8) if kind == "bytes" else value)
        return {kind: len(arrays) - 1}
    if isinstance(value, np.generic):
        return value.item()
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    if isinstance(value, list):
        return [Inside(part) for part in value]
    if isinstance(value, tuple):
        return {"tuple": [Inside(part) for part in value]}
    if isinstance(value, dict):
        return {"dict": {name: Inside(part) for name, part in value.items()}}
    if isinstance(value, records) and is_dataclass(value):
        parts = {field.name: Inside(getattr(value, field.name)) for field in fields(value)}
        return {"record": type(value).__name__, "fields": parts}
    raise TypeError(f"a {type(value).__name__} cannot be saved")


def Decoded(value: Any, arrays: Sequence[np.ndarray], records: dict[str, type]) -> Any:
    """The inverse of `Encoded`; `records` by their names."""

    def Inside(part: Any) -> Any:
        return Decoded(part, arrays, records)

    if isinstance(value, list):
        return [Inside(part) for part in value]
    if not isinstance(value, dict):
        return value
    kind, content = next(iter(value.items()))
    if kind == "array":
        return arrays[content]
    if kind == "bytes":
        return arrays[content].tobytes()
    if kind == "tuple":
        return tuple(map(Inside, content))
    if kind == "dict":
        return {name: Inside(part) for name, part in content.items()}
    return records[content](**{name: Inside(part) for name, part in value["fields"].items()})
