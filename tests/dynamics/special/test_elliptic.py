"""Elliptic functions from the complementary parameter keep their digits down to the separatrix."""

import mpmath as mp
import numpy as np
import pytest

from inertia.dynamics.special import double_double, elliptic

PARAMETERS = [1.0, 0.999, 0.3, 1e-2, 1e-4, 1e-8, 1e-12, 1e-16, 1e-24, 1e-32]


def arguments(mc: float) -> np.ndarray:
    quarter = float(mp.ellipk(1 - mp.mpf(mc)))
    return quarter * np.array([0.0, 1e-9, -0.3, 0.7, 0.999999, -1.0])


@pytest.fixture(autouse=True)
def digits() -> object:
    with mp.workdps(60):
        yield


@pytest.mark.parametrize("mc", PARAMETERS)
def test_jacobi_functions_are_right_to_the_last_digits(mc: float) -> None:
    u = arguments(mc)
    answer = elliptic.sncndn(np.append(u, 2.7 * u[2]), mc)
    for kind, values in zip(("sn", "cn", "dn"), answer, strict=True):
        true = [float(mp.ellipfun(kind, mp.mpf(x), m=1 - mp.mpf(mc))) for x in np.append(u, 2.7 * u[2])]
        assert values == pytest.approx(true, abs=4e-16)


@pytest.mark.parametrize("mc", [1e-16, 1e-32])
def test_dn_keeps_its_relative_accuracy_where_it_is_smallest(mc: float) -> None:
    u = arguments(mc)[-2]
    _, _, dn = elliptic.sncndn(u, mc)
    assert float(dn) == pytest.approx(float(mp.ellipfun("dn", mp.mpf(u), m=1 - mp.mpf(mc))), rel=1e-13)


def test_separatrix_functions_are_hyperbolic_at_any_argument() -> None:
    u = np.array([0.0, 0.5, -20.0, 1e9])
    sn, cn, dn = elliptic.sncndn(u, 0.0)
    assert sn == pytest.approx(np.tanh(u), abs=1e-16)
    assert cn.tolist() == dn.tolist()
    assert cn == pytest.approx([1.0, 1 / np.cosh(0.5), 1 / np.cosh(20.0), 0.0], rel=1e-15, abs=1e-300)


def test_parameters_and_arguments_broadcast() -> None:
    sn, _, _ = elliptic.sncndn(np.array([0.1, 0.2, 0.3]), np.array([[0.0], [0.5]]))
    assert sn[0] == pytest.approx(np.tanh([0.1, 0.2, 0.3]))
    assert sn[1, 2] == pytest.approx(float(mp.ellipfun("sn", 0.3, m=0.5)))


@pytest.mark.parametrize("mc", PARAMETERS)
def test_first_kind_undoes_the_jacobi_functions(mc: float) -> None:
    for u in arguments(mc)[:-2]:
        sn, cn = (mp.ellipfun(kind, mp.mpf(float(u)), m=1 - mp.mpf(mc)) for kind in ("sn", "cn"))
        assert float(elliptic.first_kind(float(sn), float(cn), mc)) == pytest.approx(u, rel=1e-15)


@pytest.mark.parametrize("n", [0.0, 1e-20, 0.3, 1.0])
@pytest.mark.parametrize("mc", PARAMETERS)
def test_third_kind_is_the_integral_that_it_names(mc: float, n: float) -> None:
    m, terms = 1 - mp.mpf(mc), arguments(mc)
    functions = elliptic.sncndn(terms, mc)
    answer = elliptic.third_kind(*functions, np.asarray(mc), np.asarray(n))
    for u, value in zip(terms, answer, strict=True):
        s, c, d = (mp.ellipfun(kind, mp.mpf(float(u)), m=m) for kind in ("sn", "cn", "dn"))
        p = 1 + mp.mpf(n) * s * s
        true = s * mp.elliprf(c * c, d * d, 1) - (1 + mp.mpf(n)) * s**3 / 3 * mp.elliprj(c * c, d * d, 1, p)
        assert value == pytest.approx(float(true), abs=1e-15)


@pytest.mark.parametrize("n", [0.0, 0.3, 1.0])
@pytest.mark.parametrize("mc", [*PARAMETERS, 1e-100])
def test_complete_integrals_have_thirty_digits(mc: float, n: float) -> None:
    with mp.workdps(130):
        quarter, third = (
            mp.mpf(float(high)) + mp.mpf(float(low))
            for high, low in elliptic.complete(double_double.square_root((mc, 0.0)), (n, 0.0))
        )
        share = mp.mpf(mc) / (1 + mp.mpf(n))
        assert abs(quarter / mp.ellipk(1 - mp.mpf(mc)) - 1) < 1e-30
        assert abs(third / (share / 3 * mp.elliprj(0, mc, 1, share)) - 1) < 1e-30 if mc < 1 or n > 0 else True


@pytest.mark.parametrize("n", [0.0, 0.3])
def test_complete_integrals_of_many_are_those_of_each(n: float) -> None:
    kc = double_double.square_root((np.array([*PARAMETERS, 1e-100]), np.zeros(11)))
    together = elliptic.complete(kc, (n, 0.0))
    for k, (high, low) in enumerate(zip(*kc, strict=True)):
        for answer, alone in zip(together, elliptic.complete((float(high), float(low)), (n, 0.0)), strict=True):
            assert answer[0][k] == alone[0]
            assert answer[1][k] == pytest.approx(alone[1], abs=1e-30 * alone[0])


@pytest.mark.parametrize("mc", [*PARAMETERS, 0.0])
@pytest.mark.parametrize("u", [0.0, 0.4, -1.3])
def test_floats_give_the_floats_that_arrays_hold(u: float, mc: float) -> None:
    functions = elliptic.sncndn(u, mc)
    values = *functions, elliptic.first_kind(*functions[:2], mc), elliptic.third_kind(*functions, mc, 0.3)
    arrays = elliptic.sncndn(np.array([u]), np.array([mc]))
    first, third = elliptic.first_kind(*arrays[:2], mc), elliptic.third_kind(*arrays, np.array([mc]), 0.3)
    for value, array in zip(values, (*arrays, first, third), strict=True):
        assert type(value) is float
        assert array[0] == pytest.approx(value, abs=4e-16)
