"""Options as Python classes, made from the one description that the program has of them."""

from __future__ import annotations

import json
import math
import operator

from . import _core
from ._core import OptionError

_classes: dict[str, type[Options]] = {}  # by name, "field.SteadyGvf"


def _plain(value):
    """What JSON knows in the place of a value: of a method its name and members, of NumPy's numbers Python's."""
    if isinstance(value, Options):
        return value._as_method()
    if hasattr(value, "item") and getattr(value, "ndim", 1) == 0:
        return value.item()
    if hasattr(value, "tolist"):
        return value.tolist()
    return [_plain(one) for one in value] if isinstance(value, (list, tuple, range)) else value


class _Option:
    """One member of options: reads, checks and sets it."""

    def __init__(self, facts: dict):
        self.name: str = facts["name"]
        self.kind: str = facts["kind"]
        self.classes: tuple[str, ...] = tuple(facts.get("classes", ()))
        self.words: tuple[str, ...] = tuple(facts.get("words", ()))
        self.__doc__ = _doc_of(facts)

    def __get__(self, options, owner=None):
        return self if options is None else options.__dict__[self.name]

    def __set__(self, options, value):
        options.__dict__[self.name] = self.checked(type(options), value)

    def checked(self, owner, value):
        """The value as the program takes it. Raises OptionError with its own line."""
        if isinstance(value, Options) and type(value)._name in self.classes:
            return value
        wanted = self.__doc__.splitlines()[0]
        if isinstance(value, Options):
            raise OptionError(f"option {self.name} is {value!r}; expected {wanted}")
        plain = _plain(value)
        if isinstance(plain, float) and not math.isfinite(plain):
            _core.options_set(owner._name, "", f"{self.name}={plain}")  # says what is expected
        try:
            text = json.dumps({self.name: plain})
        except TypeError:
            raise OptionError(f"option {self.name} is {value!r}; expected {wanted}") from None
        return self.built(json.loads(_core.options_resolve(owner._name, text))[self.name])

    def plain(self, value):
        """What JSON has in the place of the value."""
        return value.to_dict() if self.kind == "group" else _plain(value)

    def built(self, plain):
        """The value from what JSON has of it."""
        if self.kind == "group":
            return _classes[self.classes[0]]._built(plain)
        if self.kind == "family":
            return next(_classes[c] for c in self.classes if _classes[c]._method == plain["method"])._built(plain)
        return plain


class Options:
    """Base of all options.

    Every member is checked as it is set, by the program's own rules and with its own words.
    """

    _name = ""
    _method = ""
    _members: dict[str, _Option] = {}

    def __init__(self, **members):
        unknown = next((name for name in members if name not in self._members), None)
        if unknown is not None:
            _core.options_resolve(self._name, json.dumps({unknown: None}))  # says what it may have meant
        self.__dict__.update(self._built(json.loads(self._defaults)).__dict__)
        for name, value in members.items():
            setattr(self, name, value)

    @classmethod
    def _built(cls, plain):
        options = cls.__new__(cls)
        for name, member in cls._members.items():
            options.__dict__[name] = member.built(plain[name])
        return options

    def __setattr__(self, name, value):
        if name not in self._members:
            raise AttributeError(f"{type(self).__name__} has no option {name}; options: {', '.join(self._members)}")
        self._members[name].__set__(self, value)

    def __delattr__(self, name):
        raise AttributeError(f"option {name} cannot be removed")

    def __dir__(self):
        return [*self._members, "from_json", "set", "to_dict", "to_json"]

    def __eq__(self, other):
        return type(other) is type(self) and other.to_dict() == self.to_dict()

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self):
        default = json.loads(self._defaults)
        changed = [f"{n}={getattr(self, n)!r}" for n, m in self._members.items() if m.plain(getattr(self, n)) != default[n]]
        return f"{self._name}({', '.join(changed)})"

    def __reduce__(self):
        return _from_json, (self._name, self.to_json())

    def to_dict(self) -> dict:
        """The members as plain values; of a member that is one of several methods, its name as "method"."""
        return {name: member.plain(getattr(self, name)) for name, member in self._members.items()}

    def _as_method(self):
        return ({"method": self._method} if self._method else {}) | self.to_dict()

    def to_json(self) -> str:
        """The file that the command line reads with ``--options`` and writes as options.json."""
        return _core.options_resolve(self._name, json.dumps(self.to_dict()))

    @classmethod
    def from_json(cls, text: str):
        """Options from such a file's text; what it does not name keeps its default.

        Raises
        ------
        OptionError
            For an unknown name, a wrong type or a value out of range, in one line with its path.
        """
        return cls._built(json.loads(_core.options_resolve(cls._name, text)))

    def set(self, assignment: str) -> None:
        """One ``--set`` of the command line: ``options.set("edges.sigma_px=1.8")``."""
        plain = json.loads(_core.options_set(self._name, self.to_json(), assignment))
        self.__dict__.update(self._built(plain).__dict__)


def _from_json(name, text):
    return _classes[name].from_json(text)


def _doc_of(facts):
    """Text of one member: what it does, its kind, unit, range and choices."""
    parts = [facts["kind"]]
    if facts["unit"]:
        parts.append(facts["unit"])
    low, high = facts["min"], facts["max"]
    if math.isfinite(low) and math.isfinite(high):
        parts.append(f"{low:g} to {high:g}")
    elif math.isfinite(low):
        parts.append(f">= {low:g}")
    if "words" in facts:
        parts.append(" | ".join(facts["words"]))
    if facts["kind"] == "family":
        parts.append(" | ".join(facts["classes"]))
    elif facts["kind"] == "group":
        parts = list(facts["classes"])
    return f"{', '.join(parts)}\n    {facts['doc']}."


def _class_of(entry):
    room, name = entry["name"].split(".")
    members = {facts["name"]: _Option(facts) for facts in entry["members"]}
    listed = "\n".join(f"{n} : {m.__doc__}" for n, m in members.items())
    body = dict(members, _name=entry["name"], _method=entry["method"], _members=members, _defaults=entry["defaults"])
    body["__doc__"] = f"Options of dynasurf.{room}.\n\nParameters\n----------\n{listed}\n"
    body["__module__"] = f"dynasurf.{room}"
    return type(name, (Options,), body)


for _entry in _core.options_described():
    _classes[_entry["name"]] = _class_of(_entry)


def classes_of(room: str) -> dict[str, type[Options]]:
    """The options classes of one room, by their names."""
    return {name.split(".")[1]: c for name, c in _classes.items() if name.startswith(room + ".")}


def text_of_method(options, default: str, kinds: tuple[str, ...]) -> str:
    """JSON of one method of a family: an options object, a method's word, or None for the default."""
    if options is None:
        options = _classes[default]()
    if isinstance(options, str):
        return json.dumps(options)
    if not isinstance(options, Options) or type(options)._name not in kinds:
        raise OptionError(f"options are {options!r}; expected one of {', '.join(kinds)}")
    return json.dumps(options._as_method())


def text_of(options, name: str, members: dict | None = None) -> str:
    """JSON of options of one class, or of None for the defaults, with members set by keyword."""
    if options is None:
        options = _classes[name]()
    if type(options) is not _classes[name]:
        raise OptionError(f"options are {options!r}; expected {name}")
    if members:
        options = _classes[name]._built(options.to_dict())
        for member, value in members.items():
            if member not in options._members:
                _core.options_resolve(name, json.dumps({member: None}))
            setattr(options, member, value)
    return options.to_json()
