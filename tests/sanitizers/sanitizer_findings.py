"""Reports of the sanitizers, read from what a process writes."""

import re
from dataclasses import dataclass

__all__ = ["Finding", "Findings"]

START = re.compile(
    r"^[^/]*(?P<place>/\S+?:\d+)(?::\d+)?: runtime error: (?P<what>.*)$"  # after dots of pytest
    r"|^(?:==\d+==ERROR|WARNING): (?P<tool>\w+Sanitizer): (?P<kind>[^(]*)"
)
FRAME = re.compile(r"^\s+#\d+ 0x[0-9a-f]+ (?:in )?(?P<frame>.*)$")
OURS = re.compile(
    r"/cpp/(linear|mesh|surface|pairing|space|contact)/|/cpp/\w+\.[ch]pp|/_?ngslac[^/]*\.so"
)
VARYING = re.compile(r"( on address |\bat pc\b).*|0x[0-9a-f]+|-?\d+(\.\d+)?(e[+-]?\d+)?")
# Errors of the wheel. What it hands to Python, such as mesh[el].GetTrafo() or fes.GetFE(el), it has
# from new char[], and gives back by delete: that is harmless, but not for ngslac to change.
KNOWN = re.compile(
    r"alloc-dealloc-mismatch.*"
    r"class_<ngfem::(FiniteElement|ElementTransformation)[^\n]*::dealloc_without",
    re.DOTALL,
)
MOST = 12  # frames shown


@dataclass
class Finding:
    """What a sanitizer complains of."""

    what: str  # in its words, without addresses and numbers
    frames: list[str]  # of all stacks that it shows, innermost first
    place: str = ""  # file and line, where they are known

    @property
    def ours(self):
        """Whether it goes through ngslac's compiled code."""
        return any(OURS.search(line) for line in (self.place, *self.frames))

    @property
    def known(self):
        """Whether it is an error of the wheel that is listed above."""
        return bool(KNOWN.search("\n".join((self.what, *self.frames))))

    @property
    def where(self):
        """The first place in ngslac, or else the first one at all."""
        lines = [self.place, *self.frames]
        return next((line for line in lines if OURS.search(line)), next(filter(None, lines), ""))

    def Text(self):
        owner = "ngslac" if self.ours else "elsewhere"
        lines = [f"{owner}: {self.what}", self.place, *self.frames[:MOST]]
        return "\n        ".join(filter(None, lines))

    @property
    def key(self):
        """The same for the same error in another place of memory."""
        return self.what, self.where.rsplit(" ", 1)[-1]


def Findings(text):
    """All reports in the output of a process, also of one that they have ended."""
    found = []
    for line in text.splitlines():
        if start := START.match(line):
            what = start["what"] or f"{start['tool']}: {start['kind']}"
            hidden = VARYING.sub(lambda varying: "" if varying[1] else "..", what).strip()
            found.append(Finding(hidden, [], start["place"] or ""))
        elif found and (frame := FRAME.match(line)):
            found[-1].frames.append(frame["frame"])
    return found
