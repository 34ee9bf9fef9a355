"""Finds statements that a comma separates: `a = 1, b = 2;` is two statements on one line.

comma_statements(text) gives the lines on which C++ text has such statements. Declarations of several variables, headers of
`for`, arguments of templates, initialisers of matrices, and commas inside of parentheses, brackets and braces are none.
"""
import re

TOKEN = re.compile(
    r"""(?P<space>\s+)|(?P<comment>//[^\n]*|/\*.*?\*/)"""
    r"""|(?P<text>R"(?P<mark>[^()\s\\]{0,16})\(.*?\)(?P=mark)"|"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])+')"""
    r"""|(?P<name>[A-Za-z_]\w*)|(?P<number>\.?\d(?:[\w.']|[eEpP][+-])*)"""
    r"""|(?P<sign><<=|>>=|<<|->|::|\+\+|--|&&|\|\||[-+*/%&|^=!<>]=|.)""",
    re.S)
# Words that begin a declaration, or what is no expression.
OTHER = set("""using typedef template static_assert goto case default break continue namespace struct class enum union friend
public private protected delete extern operator throw const static constexpr auto unsigned signed int double bool float char
long short void volatile thread_local mutable inline typename alignas""".split())
BEFORE_BLOCK = {")", "else", "do", "try", "const", "noexcept", "override", "mutable", "final"}
IN_TEMPLATE = {"::", ",", "*", "&", "<", ">", "()", "+", "<<"}


def tokens(text):
    """(kind, text, line) of each token that is no space, comment or preprocessor line."""
    found, at, line = [], 0, 1
    while at < len(text):
        if at == 0 or text[at - 1] == "\n":
            directive = re.compile(r"[ \t]*#(?:[^\n\\]|\\.)*", re.S).match(text, at)
            if directive:
                line += directive[0].count("\n")
                at = directive.end()
                continue
        token = TOKEN.match(text, at)
        kind = "text" if token.lastgroup == "mark" else token.lastgroup
        if kind not in ("space", "comment"):
            found.append((kind, token[0], line))
        line += token[0].count("\n")
        at = token.end()
    return found


def opens_block(found, at, in_block):
    """Whether the brace at this index begins statements, not values or members."""
    before = found[at - 1][1] if at else ""
    if before in (";", "{", "}", ":"):
        return in_block
    if before in BEFORE_BLOCK:
        return True
    if before == "]":  # a lambda without parameters; an index has a name before it
        depth, k = 0, at - 1
        while k >= 0:
            depth += (found[k][1] == "]") - (found[k][1] == "[")
            if depth == 0:
                break
            k -= 1
        is_index = k > 0 and (found[k - 1][0] == "name" and found[k - 1][1] != "return" or found[k - 1][1] in (")", "]"))
        return not is_index
    for k in range(at - 1, max(at - 30, -1), -1):  # the type that a lambda or function returns
        if found[k][1] == "->":
            return True
        if found[k][1] in (";", "{", "}", "=", "return", ","):
            return False
    return False


def without_templates(statement):
    """The tokens without the arguments of templates, in angle brackets."""
    left, k = [], 0
    while k < len(statement):
        if statement[k][1] == "<" and left and left[-1][0] == "name":
            depth, end = 0, k
            while end < len(statement):
                kind, word, _ = statement[end]
                if not (kind in ("name", "number") or word in IN_TEMPLATE):
                    break
                depth += (word == "<") - (word == ">")
                end += 1
                if depth == 0:
                    break
            if depth == 0:
                k = end
                continue
        left.append(statement[k])
        k += 1
    return left


def declares(part):
    """Whether top-level tokens without templates begin with a type and a name."""
    k = 0
    while k < len(part) and part[k][0] == "name":
        k += 1
        if k == len(part) or part[k][1] != "::":
            break
        k += 1
    begun = k
    while k < len(part) and part[k][1] in ("&", "*", "&&", "const"):
        k += 1
    return begun > 0 and k < len(part) and part[k][0] == "name"


def is_separated(statement):
    """Whether a statement, given as its tokens outside of brackets, has a comma between two expressions."""
    k = 0
    while k < len(statement) and statement[k][1] in ("if", "for", "while", "switch", "else", "do", "constexpr"):
        k += 1
        if k < len(statement) and statement[k][1] == "()":
            k += 1
    part = without_templates(statement[k:])
    if part and part[0][1] == "return":
        part = part[1:]
    elif part and (part[0][1] in OTHER or declares(part)):
        return False
    words = [word for _, word, _ in part]
    # Eigen's initialiser of a matrix: m << 1, 2, 3;
    return "," in words and "<<" not in words[:words.index(",")]


def comma_statements(text):
    """The lines on which statements separated by commas end, ascending."""
    found, lines = tokens(text), []
    frames, statement = [], []  # an open bracket: whether it is a block, and the statement around it
    for at, (kind, word, line) in enumerate(found):
        in_block = bool(frames) and frames[-1][0]
        if kind == "sign" and word in "({[":
            frames.append((word == "{" and opens_block(found, at, in_block), statement))
            statement = []
        elif kind == "sign" and word in ")}]":
            was_block, around = frames.pop() if frames else (False, [])
            following = found[at + 1][1] if at + 1 < len(found) else ""
            ends = was_block and following not in (")", ",", ";", "(", ".")
            statement = [] if ends else around + [("group", "()", line)]
        elif word == ";" and (in_block or not frames):
            if in_block and is_separated(statement):
                lines.append(line)
            statement = []
        elif word == ":" and statement and statement[0][1] in ("case", "default", "public", "private", "protected"):
            statement = []
        else:
            statement.append((kind, word, line))
    return lines
