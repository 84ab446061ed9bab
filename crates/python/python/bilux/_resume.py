"""What a job on a cluster has done so far, in a folder: a driver that dies goes on from there."""

from __future__ import annotations

import io
import json
import os
import pathlib
import struct
import zipfile
import zlib
from typing import Any

import numpy as np

from ._bilux import Picture
from ._errors import Error

HEADER = struct.Struct("<IQ")
"""The checksum of a part's film, and the rays that it took."""


def _write(path: pathlib.Path, *pieces: bytes | memoryview) -> None:
    """Writes a file, whole or not at all."""
    partial = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        with partial.open("wb") as file:
            for piece in pieces:
                file.write(piece)
        partial.replace(path)
    except OSError as error:
        partial.unlink(missing_ok=True)
        raise Error(f"resume: cannot write {path}: {error}") from error


def _folder(folder: str | os.PathLike[str]) -> pathlib.Path:
    path = pathlib.Path(folder)
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise Error(f"resume: cannot make the folder {path}: {error}") from error
    return path


class Parts:
    """The parts of one picture."""

    def __init__(self, folder: str | os.PathLike[str], fingerprint: str) -> None:
        self._folder = _folder(folder)
        self._fingerprint = fingerprint
        self._plan = self._folder / "picture.json"

    def plan(self) -> dict[str, Any] | None:
        """How the picture was divided, if it was begun.

        Raises:
            Error: if it was another picture.
        """
        if not self._plan.exists():
            return None
        try:
            plan: dict[str, Any] = json.loads(self._plan.read_text("utf-8"))
            same = plan["fingerprint"] == self._fingerprint
            plan["workers"], plan["threads"], plan["may_crop"], plan["choice"]
        except (OSError, ValueError, KeyError, TypeError) as error:
            raise Error(f"resume: {self._plan} is damaged: delete the folder, or name another one ({error})") from error
        if not same:
            raise Error(
                f"resume: {self._folder} has parts of another picture (other scene or settings): delete it, or name "
                "another folder"
            )
        return plan

    def begin(self, plan: dict[str, Any]) -> None:
        """Keeps how the picture is divided."""
        _write(self._plan, json.dumps(plan | {"fingerprint": self._fingerprint}).encode())

    def read(self, part: tuple[int, ...]) -> tuple[bytes, int] | None:
        """The film of a part, and its rays; None if it is not there, or damaged."""
        try:
            content = self._file(part).read_bytes()
            checksum, rays = HEADER.unpack_from(content)
        except (OSError, struct.error):
            return None
        film = content[HEADER.size :]
        return (film, rays) if zlib.crc32(film) == checksum else None

    def write(self, part: tuple[int, ...], film: Any, rays: int) -> None:
        """Keeps a part."""
        _write(self._file(part), HEADER.pack(zlib.crc32(film), rays), memoryview(film))

    def _file(self, part: tuple[int, ...]) -> pathlib.Path:
        return self._folder / ("-".join(map(str, part)) + ".film")


class Pictures:
    """Pictures of an animation or a data set. Each is named by its number, its scene and its settings."""

    def __init__(self, folder: str | os.PathLike[str]) -> None:
        self._folder = _folder(folder)

    def read(self, name: str) -> Picture | None:
        """A picture; None if it is not there, or damaged."""
        try:
            with np.load(self._file(name), allow_pickle=False) as file:
                values = json.loads(bytes(file["values"]))
                pixels = [file[f"layer{number}"] for number in range(len(values["layers"]))]
        except (OSError, ValueError, KeyError, zlib.error, zipfile.BadZipFile, EOFError):
            return None
        layers = [(name, components, array) for (name, components), array in zip(values["layers"], pixels)]
        exposure, automatic, curve, behind = values["shown"]
        form, space, metadata, info = values["form"], values["space"], values["metadata"], values["info"]
        return Picture._restored((form, layers, (exposure, automatic, curve, behind), space, metadata, info))

    def write(self, name: str, picture: Picture) -> None:
        """Keeps a picture."""
        reduced: Any = picture.__reduce__()
        form, layers, shown, space, metadata, info = reduced[1][0]
        values = {
            "form": form,
            "layers": [(name, components) for name, components, _ in layers],
            "shown": shown,
            "space": space,
            "metadata": metadata,
            "info": info,
        }
        arrays = {f"layer{number}": pixels for number, (_, _, pixels) in enumerate(layers)}
        content = io.BytesIO()
        np.savez(content, values=np.frombuffer(json.dumps(values).encode(), np.uint8), **arrays)
        _write(self._file(name), content.getbuffer())

    def _file(self, name: str) -> pathlib.Path:
        return self._folder / f"{name}.npz"
