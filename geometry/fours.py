"""SIMD vectors of four numbers in kernels (LLVM vectors, split where a processor has none).

They serve rows of three numbers that lie one after the other; the fourth number is not used. Numbers are
multiplied and added as scalars are, so results do not depend on the processor.
"""

from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import intrinsic, models, register_model

VECTOR = ir.VectorType(ir.DoubleType(), 4)
UNDEFINED = ir.Constant(VECTOR, ir.Undefined)
Generated = tuple[Any, Callable[..., Any]]


class Four(types.Type):  # type: ignore[misc]
    """Numba's type of four numbers."""

    def __init__(self) -> None:
        super().__init__(name="four")


FOUR = Four()


@register_model(Four)
class FourModel(models.PrimitiveModel):  # type: ignore[misc]
    """Lives in a register."""

    def __init__(self, manager: Any, kind: Four) -> None:
        super().__init__(manager, kind, VECTOR)


def _lane(number: int) -> Any:
    return ir.Constant(ir.IntType(32), number)


def _shuffled(builder: Any, vector: Any, lanes: list[int]) -> Any:
    return builder.shuffle_vector(vector, UNDEFINED, ir.Constant(ir.VectorType(ir.IntType(32), 4), lanes))


def _place(context: Any, builder: Any, kind: Any, array: Any, index: Any) -> Any:
    data = context.make_array(kind)(context, builder, array).data
    return builder.bitcast(builder.gep(data, [index]), VECTOR.as_pointer())


@intrinsic
def four_at(context: Any, array: Any, index: Any) -> Generated:
    """Return array[index] and the three numbers behind it; the array has one axis."""

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        four = builder.load(_place(context, builder, signature.args[0], *args))
        four.align = 8
        return four

    return FOUR(array, index), generate


@intrinsic
def put_four(context: Any, array: Any, index: Any, four: Any) -> Generated:
    """Write four numbers from array[index] on."""

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        builder.store(args[2], _place(context, builder, signature.args[0], *args[:2])).align = 8
        return context.get_dummy_value()

    return types.void(array, index, four), generate


@intrinsic
def four_times(context: Any, number: Any) -> Generated:
    """Return one number, four times."""

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return _shuffled(builder, builder.insert_element(UNDEFINED, args[0], _lane(0)), [0, 0, 0, 0])

    return FOUR(types.float64), generate


@intrinsic
def first_last(context: Any, four: Any) -> Generated:
    """Return the second, third, fourth and first number."""

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return _shuffled(builder, args[0], [1, 2, 3, 0])

    return FOUR(four), generate


@intrinsic
def plus_product(context: Any, total: Any, one: Any, other: Any) -> Generated:
    """Return total + one * other."""

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return builder.fadd(args[0], builder.fmul(args[1], args[2]))

    return FOUR(total, one, other), generate


@intrinsic
def plus_three(context: Any, four: Any, x: Any, y: Any, z: Any) -> Generated:
    """Return four + (x, y, z, 0)."""

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        added = ir.Constant(VECTOR, [0.0] * 4)
        for lane in range(3):
            added = builder.insert_element(added, args[1 + lane], _lane(lane))
        return builder.fadd(args[0], added)

    return FOUR(four, types.float64, types.float64, types.float64), generate


@intrinsic
def three_of(context: Any, four: Any) -> Generated:
    """Return the first three numbers."""

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        three = [builder.extract_element(args[0], _lane(lane)) for lane in range(3)]
        return context.make_tuple(builder, signature.return_type, three)

    return types.UniTuple(types.float64, 3)(four), generate
