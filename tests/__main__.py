"""Run every gate: lint, format, types, import contracts, the site, tests. Arguments are passed on to pytest."""

import subprocess
import sys
import sysconfig
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PYTHON = [sys.executable, "-m"]


def main(pytest_arguments: list[str]) -> int:
    gates = {
        "ruff check": [*PYTHON, "ruff", "check"],
        "ruff format": [*PYTHON, "ruff", "format", "--check"],
        "mypy": [*PYTHON, "mypy"],
        "import contracts": [str(Path(sysconfig.get_path("scripts")) / "lint-imports"), "--no-logo"],
        "site": [sys.executable, "docs/build_site.py"],
        "pytest": [*PYTHON, "pytest", "-n", "auto", *pytest_arguments],
    }
    failed = []
    for name, command in gates.items():
        print(f"== {name}", flush=True)
        if subprocess.run(command, cwd=ROOT, check=False).returncode != 0:
            failed.append(name)
    print(f"== failed: {', '.join(failed)}" if failed else f"== all {len(gates)} gates passed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
