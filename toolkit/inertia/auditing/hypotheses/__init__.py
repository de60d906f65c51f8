"""The mistakes that are known here, one module a kind; each yields the ways in which it can be made with a link."""

from inertia.auditing.claim import Kind
from inertia.auditing.hypotheses import (
    about_point,
    axes,
    density,
    geometry,
    missing_steiner,
    principal_diagonal,
    product_signs,
    products_left_out,
    rounding,
    triangle_rule,
    units,
)

KINDS: tuple[Kind, ...] = (
    geometry.mistakes,
    missing_steiner.mistakes,
    about_point.mistakes,
    product_signs.mistakes,
    products_left_out.mistakes,
    principal_diagonal.mistakes,
    axes.mistakes,
    units.mistakes,
    density.mistakes,
    triangle_rule.mistakes,
    rounding.mistakes,
)
