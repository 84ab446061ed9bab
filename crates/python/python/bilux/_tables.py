"""The tables of variants, as Rust has them: what is added there is here, with its documentation."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterator
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

from ._bilux import Spec, rows
from ._calibrated import of_opencv


class Parameter(NamedTuple):
    """A parameter of an entry.

    Attributes:
        name: its name.
        summary: what it is, in a line.
        values: the values that it can take, in words.
        unit: its unit, or nothing.
        default: its default, or nothing if a value is required.
    """

    name: str
    summary: str
    values: str
    unit: str
    default: str


class Entry(NamedTuple):
    """A row of a table.

    Attributes:
        name: its name.
        summary: what it is, in a line.
        source: the paper that it comes from, if any.
        parameters: its parameters.
    """

    name: str
    summary: str
    source: str
    parameters: tuple[Parameter, ...]

    def describe(self) -> str:
        """The entry and its parameters, as text."""
        text = self.summary[:1].upper() + self.summary[1:] + "."
        if self.source:
            text += f" [{self.source}]"
        for parameter in self.parameters:
            unit = f", in {parameter.unit}" if parameter.unit else ""
            default = f"by default {parameter.default}" if parameter.default else "required"
            text += f"\n    {parameter.name}: {parameter.summary} ({parameter.values}{unit}; {default})"
        return text


class Table:
    """A table of variants.

    Call it for a list of its entries; iterate over it for their names; look one up by its name.

    Example:
        >>> "path" in [entry.name for entry in bilux.integrators()]
        True
        >>> bilux.tonemaps["agx"].name
        'agx'
    """

    def __init__(self, name: str, summary: str) -> None:
        self._name = name
        self.__doc__ = f"{summary[:1].upper()}{summary[1:]}: a table of entries; see `Table`."

    @cached_property
    def _entries(self) -> dict[str, Entry]:
        def entry(row: dict[str, Any]) -> Entry:
            parameters = tuple(Parameter(*parameter) for parameter in row["parameters"])
            return Entry(row["name"], row["summary"], row["source"], parameters)

        return {row["name"]: entry(row) for row in rows(self._name)}

    def __call__(self) -> list[Entry]:
        """All entries, in the order of the table."""
        return list(self._entries.values())

    def __getitem__(self, name: str) -> Entry:
        if name not in self._entries:
            raise KeyError(f"there is no '{name}' among the {self._name}: there are {', '.join(self)}")
        return self._entries[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._entries)

    def __len__(self) -> int:
        return len(self._entries)

    def __repr__(self) -> str:
        return f"<bilux.{self._name.replace('-', '_')}: {', '.join(self)}>"


_Function = TypeVar("_Function", bound=Callable[..., Spec])


class _Made:
    """A function of a table, which the table makes with its documentation."""

    def __init__(self, function: Callable[..., Spec]) -> None:
        self._function = function

    def __get__(self, makers: Makers | None, owner: object = None) -> Callable[..., Spec]:
        return self._function if makers is None else makers._maker(self._function.__name__)


def made(function: _Function) -> _Function:
    """A function of a table: what it says are its parameters and their types, for editors and checkers of types."""
    return _Made(function)  # type: ignore[return-value]


class Makers(Table):
    """A table of what scenes are made of: each entry's name is a function that makes one.

    Example:
        >>> glass = bilux.materials.dielectric(eta=1.5)
        >>> lamp = bilux.lights.point(position=(0, 3, 0), intensity=10)
    """

    if not TYPE_CHECKING:  # For types, there are only the functions that are written down (`_makers`).

        def __getattr__(self, kind):
            return self._maker(kind)

    def _maker(self, kind: str) -> Callable[..., Spec]:
        # What has a dash in its name has an underscore here.
        if not kind.startswith("_") and kind.replace("_", "-") in self._entries:
            kind = kind.replace("_", "-")
        if kind.startswith("_") or kind not in self._entries:
            known = "" if kind.startswith("_") else f": there are {', '.join(self)}"
            raise AttributeError(f"there is no '{kind}' in bilux.{self._name}{known}")
        entry = self._entries[kind]

        def make(*, name: str = "", **parameters: Any) -> Spec:
            return Spec(self._name, kind, parameters, name)

        make.__name__ = make.__qualname__ = kind
        make.__doc__ = entry.describe()
        word = inspect.Parameter
        keys = ["name", *(parameter.name for parameter in entry.parameters)]
        signature = inspect.Signature([word(key, word.KEYWORD_ONLY, default=None) for key in keys])
        make.__signature__ = signature  # type: ignore[attr-defined]
        return make

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self]


class Cameras(Makers):
    """The kinds of camera. Those of OpenCV take its matrices too, and what has a dash in its name has an underscore here.

    Example:
        >>> camera = bilux.cameras.perspective(position=(0, 1, 4), look_at=(0, 0, 0), fov=35)
    """

    def _maker(self, kind: str) -> Callable[..., Spec]:
        known = kind.replace("_", "-")
        make = super()._maker(known if known in self._entries and not kind.startswith("_") else kind)
        return of_opencv(known, make) if known.startswith("opencv") else make

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *(kind.replace("-", "_") for kind in self)]


accels = Table("accels", "acceleration structures for ray queries")
aovs = Table("aovs", "what a render can give besides its picture")
denoisers = Table("denoisers", "denoisers, the best first")
densities = Table("densities", "densities of media that are formulas, for `Grid.computed`")
filters = Table("filters", "pixel reconstruction filters")
formats = Table("formats", "formats of scene files")
generators = Table("generators", "built-in scenes")
integrators = Table("integrators", "algorithms that compute light")
metrics = Table("metrics", "measures of how much a picture differs from a reference")
picture_formats = Table("picture-formats", "formats of picture files")
sensor = Table("sensor", "what can be said of a sensor, for `Picture.sensor`")
settings = Table("settings", "settings of a render")
tonemaps = Table("tonemaps", "tone curves for displays")
