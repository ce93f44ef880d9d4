"""Nobody but the stepper writes its attributes, and its step reads as the algorithm does."""

import ast
import inspect
from pathlib import Path

import pytest

from toile.engine.step.step import ClothStepper

ROOT = Path(__file__).resolve().parents[3]
SOURCES = sorted(
    path for room in ("engine", "dressing", "studies", "bench") for path in (ROOT / room).rglob("*.py")
)


def written(node: ast.AST) -> list[ast.expr]:
    """What a statement assigns to."""
    if isinstance(node, ast.Assign):
        return [part for target in node.targets for part in getattr(target, "elts", [target])]
    return [node.target] if isinstance(node, ast.AugAssign | ast.AnnAssign) else []


def belongs_to_a_stepper(target: ast.expr) -> bool:
    """Whether a target is an attribute of something called a stepper, or an entry of one."""
    while isinstance(target, ast.Subscript):
        target = target.value
    owner = target.value if isinstance(target, ast.Attribute) else None
    name = owner.attr if isinstance(owner, ast.Attribute) else getattr(owner, "id", "")
    return name == "stepper"


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: str(path.relative_to(ROOT)))
def test_no_module_writes_attributes_of_a_stepper(path: Path) -> None:
    lines = [
        target.lineno
        for node in ast.walk(ast.parse(path.read_text()))
        for target in written(node)
        if belongs_to_a_stepper(target)
    ]
    assert not lines, f"{path.relative_to(ROOT)}, lines {lines}: call a method of the stepper instead"


def test_a_step_is_short() -> None:
    assert len(inspect.getsourcelines(ClothStepper.step)[0]) < 40
