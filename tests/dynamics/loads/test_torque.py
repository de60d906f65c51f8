import math
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.dynamics.oracle import rotate

from inertia.dynamics.integrators.rotation import RotationProblem
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.loads.torque import Torque, TorqueTable, read_table
from inertia.dynamics.models.stepped.solve import solve_stepped
from inertia.errors import GeometryError, ReadError, UsageError

STEP = Torque(table=TorqueTable([0.0, 1.0, 1.0, 3.0], [[0, 0, 0], [0, 0, 2], [0, 0, 6], [0, 0, 0]]))
BODY = RotationProblem(np.ones(3), np.zeros(3))
AT_REST = np.array(quaternion.IDENTITY), np.zeros(3), BODY


@pytest.mark.parametrize(("time", "expected"), [(0.0, 0.0), (0.25, 0.5), (1.0, 6.0), (2.0, 3.0), (3.0, 0.0)])
def test_torque_is_linear_between_rows_and_jumps_where_two_share_an_instant(time: float, expected: float) -> None:
    assert STEP.torque_at(time, *AT_REST).tolist() == [0.0, 0.0, expected]


@pytest.mark.parametrize("method", [None, "splitting 4", "RK4", "DOP853"])
def test_table_about_an_axis_integrates_to_its_area(method: str | None) -> None:
    """I₃ = 2: ω = ½ ∫N dt = ½ (1 + 6); the angle is ½ ∫ (3 − t) N dt = ½ (7/3 + 8)."""
    problem = RotationProblem([1.0, 1.5, 2.0], [0.0, 0.0, 0.0], loads=(STEP,))
    motion = solve_stepped(problem, [0.0, 1.0, 3.0], 1e-9, method)
    assert motion.angular_velocity[:, 2] == pytest.approx([0.0, 0.5, 3.5], abs=1e-8)
    angle = 2 * np.arctan2(motion.attitude[2, 2], motion.attitude[2, 3])
    assert np.mod(angle - 31.0 / 6.0 + 1.0, 2 * np.pi) == pytest.approx(1.0, abs=1e-8)


def test_a_table_stays_as_it_was_given() -> None:
    rows = np.array([[0, 0, 0, 0], [1, 0, 0, 2.0]])
    load = Torque(table=rows)
    rows *= 7
    assert load.table.torques.tolist() == [[0, 0, 0], [0, 0, 2]]


def test_run_must_not_leave_the_table() -> None:
    problem = RotationProblem([1.0, 1.5, 2.0], [0.0, 0.0, 1.0], loads=(STEP,))
    with pytest.raises(UsageError, match=r"covers 0 … 3 s, and the run leaves it at .* s: extend"):
        solve_stepped(problem, [0.0, 5.0], 1e-6)


PULSE = np.array([0.5, 0.1, 0.0])


def during(first: float, last: float) -> Torque:
    """Return a torque that acts between two instants, and says so nowhere."""
    return Torque(lambda time, attitude, omega: PULSE * (first <= time < last))


@pytest.mark.parametrize(("first", "last"), [(2.9, 2.92), (0.0, 0.008), (7.992, 8.0)])
@pytest.mark.parametrize("method", [None, "LSODA"])
def test_pulse_of_a_function_is_not_stepped_over(first: float, last: float, method: str | None) -> None:
    """Three runs of the oracle, without, with and without the torque."""
    moments, spin, attitude = [1.0, 2.0, 3.0], [1.0, 0.5, 2.0], [0.0, 0.0, 0.0, 1.0]
    begun = RotationProblem(moments, spin, loads=(during(first, last),))
    motion = solve_stepped(begun, [0.0, 8.0], 1e-6 if method else 1e-8, method)
    for length, torque in ((first, 0.0 * PULSE), (last - first, PULSE), (8.0 - last, 0.0 * PULSE)):
        if length:
            answer = rotate(moments, spin, [length], attitude=attitude, body_torque=torque.tolist())
            spin, attitude = (
                [Fraction(*x.as_integer_ratio()) for x in row]
                for row in (answer.angular_velocity[0], answer.attitude[0])
            )
    assert answer.attitude_error(motion.attitude[1:])[0] < motion.reached
    assert "Every step was probed for pulses of the torque" in motion.remarks[0]


def gaussian(time: float) -> float:
    return math.exp(-0.5 * ((time - 6.13) / 0.002) ** 2)


def train(time: float) -> float:
    return float(time % 1.25 < 0.01)


@pytest.mark.parametrize(
    ("pulse", "area", "lever"),
    [
        (gaussian, 0.002 * math.sqrt(2 * math.pi), 0.002 * math.sqrt(2 * math.pi) * (10 - 6.13)),
        (train, 0.08, sum(0.01 * (10 - 1.25 * k - 0.005) for k in range(8))),
    ],
)
def test_pulses_about_an_axis_add_up(pulse: Callable[[float], float], area: float, lever: float) -> None:
    """I₃ = 2: ω gains ½ ∫N dt and the angle ½ ∫ (T − t) N dt."""
    torque = Torque(lambda time, attitude, omega: np.array([0.0, 0.0, 6.0 * pulse(time)]))
    motion = solve_stepped(RotationProblem([1.0, 1.5, 2.0], [0.0, 0.0, 0.25], loads=(torque,)), [0.0, 10.0], 1e-8)
    assert motion.angular_velocity[-1, 2] == pytest.approx(0.25 + 3.0 * area, abs=1e-8)
    angle = 2 * np.arctan2(motion.attitude[1, 2], motion.attitude[1, 3])
    assert np.mod(angle - 2.5 - 3.0 * lever + 1.0, 2 * np.pi) == pytest.approx(1.0, abs=1e-8)


def test_pulse_at_an_attitude_is_not_stepped_over() -> None:
    """A narrow step of the potential, passed at 1 rad: ½ I ω² gains what it falls."""

    def torque(time: float, attitude: np.ndarray, omega: np.ndarray) -> np.ndarray:
        angle = 2 * math.atan2(attitude[2], attitude[3])
        return np.array([0.0, 0.0, 50.0 * math.exp(-0.5 * ((angle - 1.0) / 0.002) ** 2)])

    problem = RotationProblem([1.0, 1.5, 2.0], [0.0, 0.0, 0.2], loads=(Torque(torque),))
    motion = solve_stepped(problem, [0.0, 8.0], 1e-8)
    fallen = 50.0 * 0.002 * math.sqrt(2 * math.pi)
    assert motion.angular_velocity[-1, 2] == pytest.approx(math.sqrt(0.04 + fallen), abs=1e-8)


def test_two_runs_that_miss_the_same_share_of_a_pulse_do_not_agree_on_the_claim() -> None:
    """Against a table of the Gaussian, stepped row by row, which is linear between its rows to within 1e-9 of it."""
    push, middle, width = (
        np.array([2.2953994426934867e-09, -2.334037796462599e-08, 1.1614809836918212e-07]),
        0.076,
        0.005,
    )

    def bell(time: float) -> np.ndarray:
        pushed: np.ndarray = push * math.exp(-(((time - middle) / width) ** 2))
        return pushed

    body: dict[str, Any] = {
        "moments": [3.297968453178947e-05, 6.686165365585966e-05, 8.128658377174037e-05],
        "angular_velocity": [0.6165806283458779, -0.5074774490302529, 0.6019094346115115],
    }
    rows = np.unique(np.concatenate([[0.0, 3.0], np.linspace(middle - 6 * width, middle + 6 * width, 501)]))
    table = Torque(table=TorqueTable(rows, [bell(t) for t in rows.tolist()]))
    truth = solve_stepped(RotationProblem(**body, loads=(table,)), [0.0, 3.0], 1e-9)
    for accuracy in (1e-4, 4e-5, 1e-5):
        motion = solve_stepped(
            RotationProblem(**body, loads=(Torque(lambda time, attitude, omega: bell(time)),)), [0.0, 3.0], accuracy
        )
        assert quaternion.angle_between(motion.attitude, truth.attitude).max() < motion.reached + 1e-8


def test_function_that_declares_its_pulses_is_not_probed() -> None:
    calls = []

    def torque(time: float, attitude: np.ndarray, omega: np.ndarray) -> np.ndarray:
        calls.append(time)
        return PULSE * (3.0 <= time < 3.5)

    declared = Torque(torque, breaks=[3.5, 3.0], longest_step=20.0)
    probed = Torque(torque)
    runs = []
    for load in (declared, probed):
        calls.clear()
        motion = solve_stepped(RotationProblem([1.0, 2.0, 3.0], [0.1, 0.0, 0.2], loads=(load,)), [0.0, 20.0], 1e-8)
        runs.append((len(calls), motion))
    assert 3 * runs[0][0] < runs[1][0]
    assert not runs[0][1].remarks
    apart = quaternion.angle_between(runs[0][1].attitude, runs[1][1].attitude).max()
    assert apart < runs[0][1].reached + runs[1][1].reached


def test_longest_step_is_kept() -> None:
    seen: list[float] = []

    def torque(time: float, attitude: np.ndarray, omega: np.ndarray) -> np.ndarray:
        seen.append(time)
        return np.zeros(3)

    solve_stepped(
        RotationProblem([1.0, 2.0, 3.0], [0.0, 0.0, 1e-3], loads=(Torque(torque, longest_step=0.5),)), [0.0, 20.0], 1e-3
    )
    assert np.diff(np.unique(seen)).max() < 0.25


def test_runge_kutta_that_steps_over_a_pulse_does_not_claim_so() -> None:
    body: dict[str, Any] = {"moments": [1.0, 2.0, 3.0], "angular_velocity": [0.1, 0.0, 0.2]}
    table = TorqueTable([0.0, 3.3, 3.3, 3.31, 3.31, 10.0], np.array([0, 0, 1, 1, 0, 0])[:, None] * PULSE)
    truth = solve_stepped(RotationProblem(**body, loads=(Torque(table=table),)), [0.0, 10.0], 1e-10)
    motion = solve_stepped(RotationProblem(**body, loads=(during(3.3, 3.31),)), [0.0, 10.0], 1e-4, "RK4")
    assert quaternion.angle_between(motion.attitude, truth.attitude).max() <= motion.reached  # which found its jumps
    bell = Torque(lambda time, attitude, omega: PULSE * math.exp(-(((time - 3.305) / 0.004) ** 2)))
    problem = RotationProblem(**body, loads=(bell,))
    with pytest.raises(GeometryError, match=r"RK4 does not reach 0\.0001 rad over 10 s"):
        solve_stepped(problem, [0.0, 10.0], 1e-4, "RK4")


@pytest.mark.parametrize(
    ("fields", "says"),
    [
        ({"torque": [0, 0, 1], "breaks": [1.0]}, r"load.breaks goes with a function only"),
        ({"torque": [0, 0, 1], "longest_step": 1.0}, r"load.longest_step goes with a function only"),
        ({"torque": lambda *_: PULSE, "longest_step": 0.0}, r"load.longest_step is 0.0: it must be positive"),
        ({"torque": lambda *_: PULSE, "breaks": ["a"]}, r"load.breaks\[0\] is 'a': it must be a number"),
        ({"torque": lambda *_: PULSE, "breaks": 1.0}, r"load.breaks must be a list"),
    ],
)
def test_breaks_that_cannot_be(fields: dict[str, Any], says: str) -> None:
    with pytest.raises(UsageError, match=says):
        Torque(**fields)


def test_rows_that_nearly_share_an_instant() -> None:
    """A rise within 1e-12 s, and one within the least span that float64 has, are jumps."""
    for gap in (1e-12, 5e-324):
        times = [0.0, gap, 1.0, 1.0 + 2.0**-40, 3.0]
        table = TorqueTable(times, [[0, 0, 0], [0, 0, 2], [0, 0, 2], [0, 0, -1], [0, 0, -1]])
        motion = solve_stepped(
            RotationProblem([1.0, 1.5, 2.0], [0.0, 0.0, 0.0], loads=(Torque(table=table),)), [0.0, 3.0], 1e-9
        )
        assert motion.angular_velocity[-1, 2] == pytest.approx(0.0, abs=1e-11)


def write(folder: Path, text: str) -> Path:
    file = folder / "torque.csv"
    file.write_text(text, encoding="utf-8")
    return file


@pytest.mark.parametrize(
    "heading",
    [
        "",
        "time,x,y,z\n",
        "\ufefftime [s], Nx, Ny, Nz\n",
        "t (s),torque_x (N m),torque_y (N·m),torque_z (Nm)\n",
        "Time/s,Mx/Nm,My/Nm,Mz/Nm\n",
        "time s,N1,N2,N3 N m\n",
        "# time,x,y,z\n",  # by numpy.savetxt
        "# of wheel 3, tuned, 2024, by hand\n\ntime,x,y,z\n# from here on\n",
        'time_s,"x, N m",τy,tau_z_Nm\n',
        "Time (Seconds),x [newton metre],y[N-m],z [Newton meters]\n",
        "TIME [S],X [NM],Y [NM],Z [NM]\n",
        "t in s,torque.x,y\xa0[N\xa0m],z torque\n",
        ",torque[0],torque[1],torque[2]\n",
        "seconds,Torque X,Moment Y,applied_z\n",
        "# time [s] torque x [N m] torque y [N m] torque z [N m]\n",
        "# run at t, x, and others, here\n",
        "# axes: x forward, y left, z up\n",
        "# t = 0 at launch, tuned, 2024, by hand\n",
        "# torque at time t\n",
        "# Time history of torque\n",
        "# t 0 to 2\n",
        "# x, y, z, part axes\n",
        "# 2024-01-01,x,y,z\n",
        "time,x,y,z\n# x,y,z,t are in part axes\n",
    ],
)
def test_csv_is_read(heading: str, tmp_path: Path) -> None:
    table = read_table(write(tmp_path, heading + "0, 1, 2, 3\n\n0.5,4,5,6\n"))
    assert table.times.tolist() == [0.0, 0.5]
    assert table.torques.tolist() == [[1, 2, 3], [4, 5, 6]]


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("0,1,2,3\n1,2,x,3\n", "line 2: 'x' is not a finite number"),
        ("t,x,y,z\n0,1,2,3\n1,2,nan,3\n", "line 3: 'nan' is not a finite number"),
        ("0,1,2,3\n1,2,3\n", "line 2: 3 columns, 4 are needed"),
        ("0,1,2,3\n1,2,3,4\n\n0.5,0,0,0\n", "line 4: time 0.5 s follows 1 s: sort"),
        ("t,x,y,z\n0,1,2,3\n", "has 1 rows, at least 2"),
        ("", "has 0 rows"),
        ("a,b\nc,d\n", "line 1: 2 columns, 4 are needed"),
        ("time,z,y,x\n0,1,0,0\n2,1,0,0\n", "line 1: column 2 is named 'z', and x in N m is read there: give time, x"),
        ("x,y,z,time\n0,1,0,0\n2,1,0,0\n", "line 1: column 1 is named 'x', and time in s is read there"),
        ("time [ms],x,y,z\n0,1,0,0\n2,1,0,0\n", r"line 1: column 1 is named 'time \[ms\]', and time in s"),
        ("time [s],x [Nmm],y [Nmm],z [Nmm]\n0,1,0,0\n2,1,0,0\n", r"column 2 is named 'x \[Nmm\]', and x in N m"),
        ("time,N2,N1,N3\n0,1,0,0\n2,1,0,0\n", "column 2 is named 'N2', and x in N m"),
        ("# time,z,y,x\n0,1,0,0\n2,1,0,0\n", "line 1: column 2 is named 'z'"),
        ('"# time,z,y,x"\n0,1,0,0\n2,1,0,0\n', "line 1: column 2 is named 'z'"),
        ("# time,z,y,x,\n0,1,0,0\n2,1,0,0\n", "line 1: column 2 is named 'z'"),
        ("# time z y x\n0,1,0,0\n2,1,0,0\n", "column 2 is named 'z', .* name them time, x, y, z or not at all"),
        ("# time;roll;pitch;yaw\n0,1,0,0\n2,1,0,0\n", "line 1: column 2 is named 'roll'"),
        ("# time [ms],x [Nmm],y [Nmm],z [Nmm]\n0,1,0,0\n2,1,0,0\n", r"column 1 is named 'time \[ms\]'"),
        ("# time [ms] x [Nmm] y [Nmm] z [Nmm]\n0,1,0,0\n2,1,0,0\n", r"column 1 is named 'time \[ms\]'"),
        ("# t / s  Mx / kNm  My / kNm  Mz / kNm\n0,1,0,0\n2,1,0,0\n", "column 2 is named 'Mx / kNm'"),
        ("# ms,z [mNm],y [mNm],x [mNm]\n# by hand\n0,1,0,0\n2,1,0,0\n", "line 1: column 1 is named 'ms'"),
        ("# time,x [kNm],y [kNm],z [kNm]\nt,x,y,z\n0,1,0,0\n2,1,0,0\n", r"line 1: column 2 is named 'x \[kNm\]'"),
        ("time (s,x,y,z\n0,1,0,0\n2,1,0,0\n", r"column 1 is named 'time \(s'"),
        ("time,torque[1],torque[2],torque[3]\n0,1,0,0\n2,1,0,0\n", r"column 2 is named 'torque\[1\]'"),
        ("time,L_x,L_y,L_z\n0,1,0,0\n2,1,0,0\n", "column 2 is named 'L_x', and x in N m"),
        ("time,x,y,z\n0,5_74,0,0\n2,1,0,0\n", "line 2: '5_74' is not a finite number"),
        ("time,x,y,z\ns,N m,N m,N m\n0,1,0,0\n2,1,0,0\n", "line 2: 's' is not a finite number"),
        ("time ms,x,y,z\n0,1,0,0\n2,1,0,0\n", "column 1 is named 'time ms'"),
        ("time,x [mN m],y,z\n0,1,0,0\n2,1,0,0\n", r"column 2 is named 'x \[mN m\]'"),
        (f"time,{','.join(f'angular_velocity_{k}' for k in 'xyz')}\n0,1,0,0\n2,1,0,0\n", "'angular_velocity_x'"),
        ("time,x,y,\n0,1,0,0\n2,1,0,0\n", "column 4 is named '', and z in N m"),
    ],
)
def test_csv_errors_name_the_line(text: str, says: str, tmp_path: Path) -> None:
    with pytest.raises(ReadError, match=says):
        read_table(write(tmp_path, text))


def test_csv_that_is_missing_or_no_text(tmp_path: Path) -> None:
    with pytest.raises(ReadError, match="cannot be read"):
        read_table(tmp_path / "absent.csv")
    (tmp_path / "torque.csv").write_bytes(b"\xff\x00")
    with pytest.raises(ReadError, match=r"torque.csv: it is no text in UTF-8: save the table as CSV in UTF-8"):
        read_table(tmp_path / "torque.csv")


@pytest.mark.parametrize(
    ("times", "torques", "says"),
    [
        ([0.0], [[0, 0, 0]], "k ≥ 2"),
        ([0.0, 1.0], [[0, 0], [0, 0]], "k ≥ 2"),
        ([0.0, 1.0], [[0, 0, 0], [0, np.inf, 0]], "not finite"),
        ([0.0, 2.0, 1.0], np.zeros((3, 3)), "back in time after row 2"),
        ([1.0, 1.0], np.zeros((2, 3)), "one instant"),
    ],
)
def test_tables_that_cannot_be(times: list[float], torques: list[list[float]], says: str) -> None:
    with pytest.raises(UsageError, match=says):
        TorqueTable(times, torques)  # type: ignore[arg-type]


def test_jumps_of_a_function_of_time_are_had_to_the_last_bit() -> None:
    wave = Torque(lambda time, attitude, omega: np.array([0.5 if time % 0.7 < 0.31 else -0.4, 0.0, math.sin(time)]))
    jumps = wave.jumps(0.0, 5.0, np.array([0.0, 0.0, 0.0, 1.0]), np.zeros(3), 500)
    assert jumps == pytest.approx(np.sort(np.concatenate([0.7 * np.arange(1, 8), 0.7 * np.arange(7) + 0.31])))
    for jump in jumps.tolist():
        assert (jump % 0.7 < 0.31) != (math.nextafter(jump, 0.0) % 0.7 < 0.31)
    steep = Torque(lambda time, attitude, omega: np.array([math.tanh(1e6 * (time - 2.0)), 0.0, 0.0]))
    assert not steep.jumps(0.0, 5.0, np.array([0.0, 0.0, 0.0, 1.0]), np.zeros(3), 500).size
