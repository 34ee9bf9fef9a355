"""Finds works that comments cite and docs/references.md does not list.

citations(text) gives (line, key) of each citation in the comments of C++ text: `Kabsch 1976`, `(Guigue and Devillers 2003)`,
`Shewchuk (1997)`, `Li et al. 2020`. A key is the first author's name and the year.
"""
import re

NAME = r"[A-ZÆØÅÖÄÜ][\w’'-]*[\w]"
CITED = re.compile(rf"(?:van |de )?({NAME})((?:, (?:and )?| and )(?:van |de )?{NAME})*( et al\.| and others)?,? \(?((?:19[3-9]|20[0-2])\d)\b")
# Names of other things that a year or a number follows.
OTHER = {"January", "OpenVDB", "Debian", "Systems", "Section", "Decision", "Figure", "Table", "Version", "Python", "Unicode"}


def citations(text):
    found = []
    comment, begun = "", 0
    for number, written in enumerate(text.split("\n") + [""], 1):
        part = re.match(r"\s*///?<? ?(.*)", written)
        if part:
            begun = begun or number
            comment += part[1] + " "
            continue
        for cited in CITED.finditer(comment):
            name = re.sub(r"[’']s$", "", cited[1])
            if name not in OTHER:
                found.append((begun, f"{name} {cited[4]}"))
        comment, begun = "", 0
        inline = written.find("//")
        for cited in CITED.finditer(written[inline:] if inline >= 0 else ""):
            if cited[1] not in OTHER:
                found.append((number, f"{cited[1]} {cited[4]}"))
    return found


def keys(table):
    """The keys of the table in docs/references.md."""
    return set(re.findall(r"^\| (\S+ \d{4}) \|", table, re.M))
