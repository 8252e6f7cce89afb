"""The exceptions of lieflow."""

from __future__ import annotations

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

    def __init__(self, argument: str, value: str, expected: str = "") -> None:
        message = f"{argument}: {value}" + (f", expected {expected}" if expected else "")
        super().__init__(message)
        self.argument = argument
        self.value = value
        self.expected = expected

    def __reduce__(self) -> tuple[type[ArgumentError], tuple[str, str, str]]:
        return (type(self), (self.argument, self.value, self.expected))


class RunError(RuntimeError):
    """A run that failed. :meth:`lieflow.Result.check` raises it."""
