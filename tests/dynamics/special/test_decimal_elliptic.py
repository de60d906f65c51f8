"""Complete and incomplete integrals against mpmath's Carlson forms and Legendre's."""

from decimal import Decimal, localcontext

import mpmath
import pytest

from inertia.dynamics.special.decimal_elliptic import complete, first_kind, pair


@pytest.mark.parametrize("kc", ["1", "0.3", "1e-8", "1e-40"])
@pytest.mark.parametrize("p", ["1e-30", "0.7", "1", "2.5", "1e12"])
@pytest.mark.parametrize(("cosine", "sine"), [(1, 1), (1, 0), (0, 1)])
def test_complete_integrals_keep_forty_digits_whatever_is_small(kc, p, cosine, sine):
    with localcontext() as context, mpmath.workdps(160):
        context.prec = 60
        answer = complete(Decimal(kc), Decimal(p), Decimal(cosine), Decimal(sine))
        third = mpmath.elliprj(0, mpmath.mpf(kc) ** 2, 1, mpmath.mpf(p)) / 3  # of sn²/(cn² + p sn²)
        first = mpmath.elliprf(0, mpmath.mpf(kc) ** 2, 1)
        true = cosine * (first - mpmath.mpf(p) * third) + sine * third
        assert abs(mpmath.mpf(str(answer)) / true - 1) < 1e-40


@pytest.mark.parametrize(("sine", "mc"), [("0.5", "0.3"), ("-0.7", "0"), ("0.999999999999", "1e-20"), ("1", "1e-30")])
def test_the_first_kind_keeps_forty_digits_up_to_the_quarter_period(sine, mc):
    with localcontext() as context, mpmath.workdps(100):
        context.prec = 60
        answer = first_kind(Decimal(sine), 1 - Decimal(sine) ** 2, Decimal(mc))
        true = mpmath.ellipf(mpmath.asin(mpmath.mpf(sine)), 1 - mpmath.mpf(mc))
        assert abs(mpmath.mpf(str(answer)) / true - 1) < 1e-40


def test_a_pair_holds_thirty_one_digits():
    with localcontext() as context:
        context.prec = 60
        third = Decimal(1) / 3
        high, low = pair(third)
        assert abs(Decimal(high) + Decimal(low) - third) < Decimal("1e-32")
