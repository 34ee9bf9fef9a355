"""Finds aggregates of four fields and more that are initialised by position: `Key{0, p, axis, 90}` hides which field is which.

positional_initialisers(texts) gives (file, line, type) of each, for texts by file name. A braced list belongs to a type that is
written before it (`Key{…}`, `Key k{…}`, `Key k = {…}`), that the function returns (`return {…}`), or of which a container in the
same file or header is made (`keys.push_back({…})`). A list of four values and more that a call takes as an argument belongs to an
aggregate, too, unless the call takes a list (`std::max({…})`). Values of arrays and of small aggregates are positional by right.
"""
import os
import re

from statements import tokens

FIELDS = 4
# Calls whose argument is a list of equal things.
TAKES_LIST = {"max", "min", "minmax", "insert", "assign", "append", "string", "vector", "array", "set", "map", "span", "row", "node"}
KEEPS = {"push_back", "push", "emplace_back", "push_front"}


def aggregates(texts, tokens_of):
    """Names of structs with at least FIELDS fields and no constructor: name -> {file: fields}."""
    found = {}
    for name, text in texts.items():
        listed = tokens_of[name]
        for at, (kind, word, _) in enumerate(listed):
            if word != "struct" or at + 2 >= len(listed) or listed[at + 2][1] != "{" or listed[at - 1][1] == "enum":
                continue
            own, fields, depth, statement, k = listed[at + 1][1], 0, 0, [], at + 2
            plain = True
            while k < len(listed):
                token = listed[k][1]
                if token in "({[":
                    depth += 1
                    if depth == 2:
                        statement.append(token)
                elif token in ")}]":
                    depth -= 1
                    if depth == 0:
                        break
                    if depth == 1 and token == "}" and ("(" in statement or "struct" in statement or "class" in statement or
                                                         "enum" in statement or "union" in statement):
                        statement = []
                elif depth == 1 and token == ";":
                    fields += count_fields(statement)
                    statement = []
                elif depth == 1 and token in ("private", "protected"):
                    plain = False
                elif depth == 1 and token == ":":
                    statement = [] if statement and statement[0] == "public" else statement + [token]
                elif depth == 1:
                    if token == own and not [w for w in statement if w not in ("explicit", "constexpr")] and \
                            k + 1 < len(listed) and listed[k + 1][1] == "(":
                        plain = False
                    statement.append(token)
                k += 1
            if plain and fields >= FIELDS:
                found.setdefault(own, {})[name] = fields
            elif own in found or plain:
                found.setdefault(own, {}).setdefault(name, 0)
    return found


def count_fields(statement):
    """How many fields a member declaration has, given as its tokens outside of brackets."""
    words = [w for w in statement if w not in ("mutable",)]
    if not words or words[0] in ("using", "static", "friend", "typedef", "template", "struct", "class", "enum", "constexpr"):
        return 0
    before = words[:words.index("=")] if "=" in words else words
    if "(" in before and "<" not in before[:before.index("(")]:
        return 0  # a function
    depth = 0
    count = 1
    in_value = False
    for word in words:
        depth += (word in ("<", "<<")) - (word == ">") - 2 * (word == ">>") if not in_value else 0
        if word == "=":
            in_value = True
        elif word == "," and depth <= 0:
            count += 1
            in_value = False
    return count


def resolved(own, name, texts, found):
    """Fields of the type with this name that a file means: its own one, one of a header that it includes, else the only one."""
    places = found.get(own)
    if not places:
        return 0
    if name in places:
        return places[name]
    headers = set(re.findall(r'#include [<"]([^>"]+)[>"]', texts[name]))
    near = [count for place, count in places.items() if any(place.endswith("/" + header) for header in headers)]
    if near:
        return max(near)
    return min(places.values())


def values(listed, at):
    """The number of values in the braced list that opens at this token, and whether its first one is named."""
    depth, count, any_value = 0, 1, False
    for k in range(at, len(listed)):
        word = listed[k][1]
        if word in "({[":
            depth += 1
            any_value |= depth > 1
        elif word in ")}]":
            depth -= 1
            if depth == 0:
                break
        elif word == "," and depth == 1:
            count += 1
        else:
            any_value = True
    return (count if any_value else 0), at + 1 < len(listed) and listed[at + 1][1] == "."


def is_block(listed, at):
    return listed[at - 1][1] in (")", "else", "do", "try", "const", "noexcept", "override", ";", "{", "}") if at else True


def parameters_before(listed, at):
    """The index of the parenthesis that opens the parameters before a brace; -1: none does."""
    k = at - 1
    while k > 0 and listed[k][1] != ")":
        k -= 1
    depth = 0
    while k >= 0:
        depth += (listed[k][1] == ")") - (listed[k][1] == "(")
        if depth == 0:
            break
        k -= 1
    return k


def returned_types(listed):
    """(first token, last token, type) of the body of each function with a return type written before its name."""
    found = []
    for at, (_, word, _) in enumerate(listed):
        if word != "{" or at == 0 or listed[at - 1][1] not in (")", "const", "noexcept"):
            continue
        k = parameters_before(listed, at) - 1
        while k > 1 and listed[k - 1][1] == "::":
            k -= 2
        if k < 1 or listed[k][0] != "name" or listed[k - 1][0] != "name":
            continue
        end, depth = at, 0
        while end < len(listed):
            depth += (listed[end][1] == "{") - (listed[end][1] == "}")
            if depth == 0:
                break
            end += 1
        found.append((at, end, listed[k - 1][1]))
    return found


def heads_type(listed, at):
    """Whether the brace opens a struct or class: `class A::B {`, `struct A : B {`."""
    k = at - 1
    while k >= 0 and listed[k][1] not in (";", "{", "}", "(", ")"):
        if listed[k][1] in ("struct", "class", "enum"):
            return True
        k -= 1
    return False


def is_lambda(listed, at):
    """Whether the brace at this index is the body of a lambda: its parameters follow a capture."""
    k = parameters_before(listed, at)
    return k > 0 and listed[k - 1][1] == "]"


def positional_initialisers(texts):
    tokens_of = {name: tokens(text) for name, text in texts.items()}
    found = aggregates(texts, tokens_of)
    for name, text in texts.items():
        listed = tokens_of[name]
        beside = text
        for end in (".h",):
            beside += texts.get(os.path.splitext(name)[0] + end, "")
        kept = dict((variable, own) for own, variable in re.findall(r"vector<(?:\w+::)*(\w+)>&?\s+(\w+)\b", beside))
        bodies = returned_types(listed)
        lambdas = [at for at, token in enumerate(listed) if token[1] == "{" and is_lambda(listed, at)]
        for at, (_, word, line) in enumerate(listed):
            if word != "{" or at < 2:
                continue
            count, named = values(listed, at)
            if count == 0 or named:
                continue
            before, earlier = listed[at - 1], listed[at - 2]
            own = ""
            if heads_type(listed, at):
                continue
            if before[0] == "name" and before[1] in found and earlier[1] not in ("struct", "class", "enum", "namespace"):
                own = before[1]
            elif before[0] == "name" and earlier[0] == "name" and earlier[1] in found:
                own = earlier[1]
            elif before[1] == "=" and at > 3 and earlier[0] == "name" and listed[at - 3][1] in found:
                own = listed[at - 3][1]
            elif before[1] == "return":
                around = [b for b in bodies if b[0] < at < b[1]]
                inner = max(around)[0] if around else -1
                in_lambda = any(inner < opened < at for opened in lambdas)
                own = max(around)[2] if around and not in_lambda else ""
            elif before[1] == "(" and earlier[1] in KEEPS and at > 4 and listed[at - 4][0] == "name":
                own = kept.get(listed[at - 4][1], "")
            if own:
                if resolved(own, name, texts, found) >= FIELDS:
                    yield name, line, own
            elif before[1] == "(" and count >= FIELDS and earlier[0] == "name" and earlier[1] not in TAKES_LIST | KEEPS and \
                    not is_block(listed, at):
                yield name, line, f"argument of {earlier[1]}()"
