from pathlib import Path

import numpy as np
import pytest

from inertia.dynamics.integrators.rotation import RotationProblem
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.loads.torque import Torque, TorqueTable, read_table
from inertia.dynamics.models.stepped.solve import solve_stepped
from inertia.errors import ReadError, UsageError

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


def test_run_must_not_leave_the_table() -> None:
    problem = RotationProblem([1.0, 1.5, 2.0], [0.0, 0.0, 1.0], loads=(STEP,))
    with pytest.raises(UsageError, match=r"covers 0 … 3 s, and the run leaves it at .* s: extend"):
        solve_stepped(problem, [0.0, 5.0], 1e-6)


def write(folder: Path, text: str) -> Path:
    file = folder / "torque.csv"
    file.write_text(text, encoding="utf-8")
    return file


@pytest.mark.parametrize("heading", ["", "time,x,y,z\n", "\ufefftime [s], Nx, Ny, Nz\n"])
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
        ("a,b\nc,d\n", "line 2: 2 columns"),
    ],
)
def test_csv_errors_name_the_line(text: str, says: str, tmp_path: Path) -> None:
    with pytest.raises(ReadError, match=says):
        read_table(write(tmp_path, text))


def test_csv_that_is_missing_or_no_text(tmp_path: Path) -> None:
    with pytest.raises(ReadError, match="cannot be read"):
        read_table(tmp_path / "absent.csv")
    (tmp_path / "torque.csv").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(ReadError, match="cannot be read"):
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
