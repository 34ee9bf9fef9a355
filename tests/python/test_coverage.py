"""Every public function of the library is in the module, or on the list in docs/python.md that says why not.

The tables are below the heading "Functions of the library". A row `| header | C++ names | Python names |` binds: its Python names
exist. A row of the second table, `| C++ names | why not |`, gives the reason. Headers are read by universal-ctags, as the style
checks do. Constructors, destructors and operators are named as their class.
"""
import inspect
import json
import pathlib
import re
import subprocess
import unittest

import kerf

ROOT = pathlib.Path(__file__).parents[2]
HEADERS = sorted((ROOT / "libgeo/include/kerf").glob("*.h"))


def public_functions():
    """The functions in public headers, as header → set of Class::name without the namespace."""
    run = subprocess.run(["ctags", "--output-format=json", "--fields=+neSaKsl", "--languages=C++", "--language-force=C++", "--kinds-C++=fp",
                          "-f", "-", "-L", "-"], input="\n".join(map(str, HEADERS)), capture_output=True, text=True, check=True)
    found = {}
    for line in run.stdout.splitlines():
        tag = json.loads(line)
        name, scope = tag["name"], re.sub(r"^geo(::|$)", "", tag.get("scope", ""))
        if tag.get("access") in ("private", "protected") or tag.get("scopeKind") == "function" or name[0] == "~" or name.startswith("operator"):
            continue
        if name == scope.rsplit("::")[-1]:
            found.setdefault(pathlib.Path(tag["path"]).name, set()).add(scope)
        else:
            found.setdefault(pathlib.Path(tag["path"]).name, set()).add(f"{scope}::{name}" if scope else name)
    return found


def tables():
    """Rows of the two tables, as lists of cells."""
    text = (ROOT / "docs/python.md").read_text()
    part = text[text.index("\n## Functions of the library\n"):]
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in part.splitlines() if line.startswith("| ") and "---" not in line]
    return [row for row in rows if len(row) == 3 and row[0] != "header"], [row for row in rows if len(row) == 2 and row[1] != "why not"]


def names(cell):
    return re.findall(r"`([^`]+)`", cell)


def there(name):
    """Whether `Class.member`, `function()`, or `Class(argument=)` exists in the module."""
    call = re.fullmatch(r"([\w.]+)\((?:(\w+)=)?\)?\)?", name)
    path, argument = (call[1], call[2]) if call else (name, None)
    value = kerf
    for word in path.split("."):
        value = inspect.getattr_static(value, word, None) if value is not kerf else getattr(kerf, word, None)
        if value is None:
            return False
    if argument:
        text = inspect.getdoc(getattr(value, "__init__", value) if isinstance(value, type) else value) or ""
        return bool(re.search(rf"\b{argument}\b", text + (inspect.getdoc(value) or "")))
    return True


class Coverage(unittest.TestCase):
    def setUp(self):
        self.functions = public_functions()
        self.bound, self.left_out = tables()

    def test_headers_are_read(self):
        self.assertEqual(len(self.functions.keys() & {"complex.h", "body.h", "mesh.h", "simulation.h"}), 4)
        self.assertGreater(sum(map(len, self.functions.values())), 250)

    def test_every_function_is_bound_or_on_the_list(self):
        listed = {name for row in self.bound for name in names(row[1])} | {name for row in self.left_out for name in names(row[0])}
        missing = [f"{header}: {name}" for header, all_names in sorted(self.functions.items()) for name in sorted(all_names - listed)]
        self.assertEqual(missing, [])

    def test_the_list_names_functions_that_exist(self):
        known = set().union(*self.functions.values())
        wrong = [name for row in self.bound for name in names(row[1]) if name not in known]
        wrong += [name for row in self.left_out for name in names(row[0]) if name not in known]
        self.assertEqual(wrong, [])
        for row in self.bound:
            for name in names(row[1]):
                self.assertIn(name, self.functions.get(row[0].strip("`"), ()), row[0])

    def test_python_names_exist(self):
        self.assertGreater(len(self.bound), 15)
        self.assertEqual([name for row in self.bound for name in names(row[2]) if not there(name)], [])
        self.assertEqual([row for row in self.bound if not names(row[2])], [])

    def test_reasons_are_given(self):
        self.assertEqual([row for row in self.left_out if len(row[1].split()) < 4], [])

    def test_everything_public_has_a_docstring(self):
        bare = []
        for name in sorted(vars(kerf)):
            value = getattr(kerf, name)
            if name.startswith("_") or inspect.ismodule(value) or not callable(value):
                continue
            bare += [name] * (not inspect.getdoc(value))
            if inspect.isclass(value):
                bare += [f"{name}.{member}" for member, what in vars(value).items()
                         if not member.startswith("_") and not (getattr(what, "__doc__", None) or "").strip()]
        self.assertEqual(bare, [])


class Members(unittest.TestCase):
    """The rule of docs/python.md for properties and methods."""

    # Searches of the whole object, protocols of Python, and exports: methods whose result is no object of the module.
    METHODS = {"crossings", "components", "keys", "to_bytes", "to_trimesh", "to_open3d", "to_trimesh_kwargs", "show"}

    def classes(self):
        return [value for name, value in sorted(vars(kerf).items()) if inspect.isclass(value) and not issubclass(value, BaseException)]

    def test_methods_without_arguments_make_objects(self):
        wrong = []
        for cls in self.classes():
            for name, member in vars(cls).items():
                signature = re.match(r"\w+\(self: [\w.]+\) -> (.*)", (getattr(member, "__doc__", None) or "").lstrip())
                if name[0] == "_" or isinstance(member, property) or not signature or name in self.METHODS:
                    continue
                made = getattr(kerf, signature[1].rsplit(".")[-1], None)
                if signature[1] != "None" and not inspect.isclass(made) and name not in ("surface", "copy"):
                    wrong.append(f"{cls.__name__}.{name}() -> {signature[1]}")
        self.assertEqual(wrong, [])

    def test_properties_hold_their_parts(self):
        model = kerf.shapes.block((1, 1, 1), edge=0.5)
        cut = model.crack(kerf.score(model, "planes", pieces=2, seed=2))
        body = kerf.Body(cut, spacing=0.4)
        simulation = kerf.Simulation("[body]\nmesh = 'x'\nspacing = 0.5\n[material]\nyoung = 1e4\n", models=model)
        seen = 0
        for thing in (model, cut, cut.pieces()[0], kerf.score(model, pieces=2), body, body.graph, simulation, simulation.solid()):
            for name in dir(type(thing)):
                if name[0] == "_" or not isinstance(getattr(type(thing), name), property):
                    continue
                value = getattr(thing, name)
                if type(value).__module__.startswith("kerf"):
                    seen += 1
                    again = getattr(thing, name)
                    self.assertTrue(again is value or again == value or not hasattr(value, "vertices"), f"{type(thing).__name__}.{name}")
        self.assertGreater(seen, 5)

    def test_no_property_hides_a_method(self):
        for cls in self.classes():
            for base in cls.__mro__[1:]:
                for name, member in vars(base).items():
                    if name[0] != "_" and name in vars(cls):
                        self.assertEqual(isinstance(member, property), isinstance(vars(cls)[name], property), f"{cls.__name__}.{name}")


if __name__ == "__main__":
    unittest.main()
