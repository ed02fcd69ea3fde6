"""The stub has the docstrings of the compiled part, and docs/API.md those of the package. KIRIGAMI_WRITE=1 writes both."""

import ast
import inspect
import os
from pathlib import Path

import kirigami._kirigami as compiled

ROOT = Path(__file__).parents[2]
STUB = ROOT / "python/kirigami/_kirigami.pyi"
PAGE = ROOT / "docs/API.md"
MODULES = ["files", "plot", "jax", "torch"]
SHOWN = (ast.ClassDef, ast.FunctionDef)
HEAD = """# The Python package, name by name

Written from the docstrings (`KIRIGAMI_WRITE=1 make python`). [PYTHON](PYTHON.md) shows how the names are used together. Units are mm, N, MPa, N mm and rad.
"""


def members(node):
    """Classes and functions of a body that are documented."""
    named = (it for it in node.body if isinstance(it, SHOWN))
    return [it for it in named if not it.name.startswith("_") or it.name == "__call__"]


def with_docstrings(text):
    """The stub with the docstrings of the compiled part."""
    lines = text.splitlines()

    def write(node, of):
        """Writes from the end, so that the lines above keep their numbers."""
        doc = inspect.getdoc(of)
        body = node.body[1:] if ast.get_docstring(node) else node.body
        for it in reversed([it for it in body if isinstance(it, SHOWN)]):
            # A call has no docstring at run time.
            if it in members(node) and it.name != "__call__":
                write(it, getattr(of, it.name))
        indent = " " * (node.col_offset + 4)
        quoted = [indent + line if line else "" for line in f'"""{doc}"""'.splitlines()]
        first = node.body[0]
        if ast.get_docstring(node):
            lines[first.lineno - 1 : first.end_lineno] = quoted
        elif isinstance(first, SHOWN):
            at = min([first.lineno, *(it.lineno for it in first.decorator_list)]) - 1
            lines[at:at] = [*quoted, ""]
        else:
            lines[first.lineno - 1] = lines[first.lineno - 1].removesuffix(" ...")
            lines[first.lineno : first.lineno] = quoted

    for node in reversed(members(ast.parse(text))):
        write(node, getattr(compiled, node.name))
    return "\n".join(lines) + "\n"


def signature(node):
    """How a name is used: a property, a call, or a function with its types."""
    kinds = [it.id for it in node.decorator_list if isinstance(it, ast.Name)]
    returns = ast.unparse(node.returns) if node.returns else ""
    if "property" in kinds:
        return f"{node.name}: {returns}"
    arguments = ast.unparse(node.args).replace("=", " = ").removeprefix("self").removeprefix("cls").removeprefix(", ")
    return f"{node.name}({arguments})" + (f" -> {returns}" if returns else "")


def entry(node, mark):
    """A function or a property with its docstring."""
    return f"{mark} `{signature(node)}`: {' '.join((ast.get_docstring(node) or '').split())}\n"


def section(name, text):
    """What a module offers."""
    parts = [f"\n## {name}\n\n"]
    for node in members(ast.parse(text)):
        if isinstance(node, ast.FunctionDef):
            parts.append(entry(node, "*"))
            continue
        made = [it for it in node.body if isinstance(it, ast.FunctionDef) and it.name in ("__new__", "__init__")]
        call = signature(made[0]).replace(made[0].name, node.name).split(" -> ")[0] if made else node.name
        parts.append(f"{'' if len(parts) == 1 else chr(10)}### `{call}`\n\n{ast.get_docstring(node)}\n\n")
        parts += [entry(it, "*") for it in members(node)]
    return "".join(parts)


def test_stub_and_page_have_the_docstrings():
    stub = with_docstrings(STUB.read_text())
    sources = {f"kirigami.{it}": (ROOT / f"python/kirigami/{it}.py").read_text() for it in MODULES}
    sections = (section(name, text) for name, text in {"kirigami": stub, **sources}.items())
    page = HEAD + "".join(sections).replace("\n>>>", "\n    >>>")
    for of_stub, name in {"_Doubles": "array", "NDArray[np.bool_]": "array", "_Path": "Path", "_Order": "str"}.items():
        page = page.replace(of_stub, name)
    for file, text in [(STUB, stub), (PAGE, page)]:
        if "KIRIGAMI_WRITE" in os.environ:
            file.write_text(text)
        assert file.read_text() == text, "run `KIRIGAMI_WRITE=1 make python`"
    assert "None\n" not in page, "a name without a docstring"
