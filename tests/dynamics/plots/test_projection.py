"""Curves on an ellipsoid seen from one side: what faces the eye, and where its outline is."""

import numpy as np
import pytest
from matplotlib.figure import Figure

from inertia.dynamics.plots.projection import Projection


def seen(semi_axes: tuple[float, float, float] = (3.0, 2.0, 1.0)) -> Projection:
    toward = np.array([1.0, 2.0, 2.0]) / 3.0
    return Projection(np.array(semi_axes), toward, np.array([0.0, 0.0, 1.0]))


def test_places_keep_lengths_across_the_view_and_lose_depth() -> None:
    view = seen()
    assert view.at(view.toward) == pytest.approx([0.0, 0.0])
    across = np.cross(view.toward, [0.3, -0.2, 0.9])
    assert np.linalg.norm(view.at(across)) == pytest.approx(np.linalg.norm(across))
    assert view.at(np.array([0.0, 0.0, 1.0]))[0] == pytest.approx(0.0)  # upright
    assert view.at(np.array([0.0, 0.0, 1.0]))[1] > 0


def test_the_outline_encloses_every_point_and_touches_those_between_front_and_back() -> None:
    view, axes = seen(), Figure().subplots()
    view.draw_surface(axes)
    outline = np.asarray(axes.patches[0].get_xy())
    turns = np.random.default_rng(2).normal(size=(4000, 3))
    points = view.semi_axes * turns / np.linalg.norm(turns, axis=1)[:, None]
    # The shadow of the ellipsoid: P diag(a²) Pᵀ.
    shadow = view.at(np.diag(view.semi_axes)).T
    form = np.linalg.inv(shadow @ shadow.T)
    assert np.einsum("ni,ij,nj->n", outline, form, outline) == pytest.approx(1.0, abs=1e-9)
    assert np.einsum("ni,ij,nj->n", view.at(points), form, view.at(points)).max() <= 1.0 + 1e-12
    assert 0.4 < view.in_front(points).mean() < 0.6
    assert view.in_front(view.toward[None]).all()
    assert not view.in_front(-view.toward[None]).any()


def test_what_is_behind_is_drawn_faintly_and_what_is_in_front_full() -> None:
    view, axes = seen((1.0, 1.0, 1.0)), Figure().subplots()
    turn = np.linspace(0.0, 2.0 * np.pi, 73)
    view.draw(axes, np.stack([np.cos(turn), np.sin(turn), 0 * turn], axis=-1), "circle", color="red")
    back, front = axes.lines
    assert (back.get_linestyle(), front.get_linestyle()) == (":", "-")
    assert back.get_alpha() is not None
    assert back.get_alpha() < 0.5
    assert front.get_label() == "circle"
    assert 0.4 < np.isfinite(np.asarray(front.get_xydata())).all(axis=1).mean() < 0.6
