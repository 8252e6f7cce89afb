"""The exceptions of lieflow."""

from __future__ import annotations

from typing import Any

__all__ = ["ArgumentError", "RunError"]


class ArgumentError(ValueError):
    """An argument that cannot be used.

    Attributes
    ----------
    argument : str
        The name of the argument, with the place of the element if it is one of an array.
    value : str
        Its value in words.
    expected : str
        What was expected. It is empty if ``value`` says it.
    """

    argument: str
    value: str
    expected: str
    #: The other mistakes of the same call, of keys of a problem.
    others: tuple[ArgumentError, ...] = ()

    def __init__(self, argument: str, value: str, expected: str = "") -> None:
        expected = expected.removeprefix("expected ")
        message = f"{argument}: {value}" + (f", expected {expected}" if expected else "")
        super().__init__(message)
        self.argument = argument
        self.value = value
        self.expected = expected

    def __reduce__(self) -> tuple[Any, ...]:
        return (_again, (type(self), self.args, self.__dict__))


def _again(kind: type[ArgumentError], args: tuple[Any, ...], values: dict[str, Any]) -> ArgumentError:
    """The error with this message and these values."""
    error = kind.__new__(kind, *args)
    error.__dict__.update(values)
    return error


def mistakes(found: list[tuple[str, str, str]]) -> ArgumentError:
    """Return the error of all mistakes in the keys of a problem: argument, what is wrong, advice."""
    errors = [ArgumentError(argument or "keys", value) for argument, value, _ in found]
    for error, (_, _, advice) in zip(errors, found):
        error.expected = advice
    return together(errors)


def together(errors: list[ArgumentError]) -> ArgumentError:
    """Return the first of some mistakes, with the words of all. An advice has its own lines, as on the command line."""
    for error in errors:
        advice = "\n  = " + error.expected.replace("\n", "\n        ") if error.expected else ""
        error.args = (f"{error.argument}: {error.value}{advice}",)
    first = errors[0]
    first.others = tuple(errors[1:])
    first.args = ("\n".join(map(str, errors)),)
    return first


class RunError(RuntimeError):
    """A run that failed. :meth:`lieflow.Result.check` raises it."""
