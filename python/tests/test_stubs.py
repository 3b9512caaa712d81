"""The stubs of the compiled half name what it has, and everything that users see says what it is."""

import ast
import inspect

import covact
from conftest import ROOT
from covact import _covact


def members(tree):
    """Names of a module or class in the stubs, and their arguments."""
    found = {}
    for node in tree.body:
        if isinstance(node, ast.FunctionDef):
            arguments = node.args
            names = [argument.arg for argument in arguments.posonlyargs + arguments.args + arguments.kwonlyargs]
            found["__new__" if node.name == "__init__" else node.name] = [name for name in names if name not in ("self", "cls")]
        elif isinstance(node, ast.ClassDef):
            found[node.name] = members(node)
        elif isinstance(node, ast.AnnAssign):
            found[node.target.id] = None
    return found


def public(thing):
    return {name for name in vars(thing) if not name.startswith("_")}


def test_stubs_name_what_there_is():
    stubs = members(ast.parse((ROOT / "python" / "covact" / "_covact.pyi").read_text(encoding="utf-8")))
    assert public(_covact) == {name for name in stubs if not name.startswith("_")}
    for name, inside in stubs.items():
        thing = getattr(_covact, name)
        if isinstance(inside, dict) and not issubclass(thing, Exception):
            assert public(thing) == {member for member in inside if not member.startswith("_")}, name
        functions = inside.items() if isinstance(inside, dict) else [(None, inside)]
        for member, arguments in functions:
            what = thing if member is None or member == "__new__" else getattr(thing, member, None)
            if arguments is None or not callable(what) or isinstance(what, type) and member is None:
                continue
            there = [argument for argument in inspect.signature(what).parameters if argument != "self"]
            assert there == arguments, f"{name}.{member}"


def test_everything_has_a_docstring():
    count = 0
    for module in (covact, covact.geometry):
        assert module.__doc__
        for name in module.__all__:
            thing = getattr(module, name)
            if name == "__version__" or inspect.ismodule(thing):
                continue
            assert inspect.getdoc(thing), name
            count += 1
            if inspect.isclass(thing):
                for member, value in vars(thing).items():
                    if not member.startswith("_") and (callable(value) or isinstance(value, (property, staticmethod, classmethod))):
                        assert inspect.getdoc(getattr(thing, member)), f"{name}.{member}"
                        count += 1
    assert count > 60
