"""The entry point of the command `inertia`: signals are listened to before anything else is imported."""

from inertia_cli.interruption import interruption


def run() -> None:
    """Run the command line of this process and leave with its exit code."""
    interruption.install()
    from inertia_cli.main import run

    run()


if __name__ == "__main__":
    run()
