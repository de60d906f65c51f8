"""Shells complete the commands, their options and their files."""

import shutil
import subprocess
from pathlib import Path

import pytest

from inertia_cli.completion import SHELLS
from inertia_cli.main import main

needs_bash = pytest.mark.skipif(shutil.which("bash") is None, reason="there is no bash")


def script(shell: str, capsys: pytest.CaptureFixture[str]) -> str:
    assert main(["completion", shell]) == 0
    return capsys.readouterr().out


@needs_bash
@pytest.mark.parametrize(
    ("words", "offered"),
    [
        (["sim"], {"simulate"}),
        (["bal"], {"balance"}),
        (["analyse", "--mat"], {"--material"}),
        (["analyse", "--orientation", ""], {"stored", "absolute"}),
        (["analyse", "par"], {"part.stl"}),
        (["simulate", "--explain", "sce"], {"scene.toml"}),
        (["balance", "par"], {"part.stl"}),
        (["balance", "measure", "--cert"], {"--certificate"}),
        (["completion", ""], {*SHELLS}),
    ],
    ids=lambda each: " ".join(each) if isinstance(each, list) else "",
)
def test_bash_offers(words: list[str], offered: set[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name in ("part.stl", "scene.toml"):
        (tmp_path / name).touch()
    line = " ".join(f"'{word}'" for word in ["inertia", *words])
    ask = (
        f"\nCOMP_WORDS=({line})\nCOMP_CWORD={len(words)}\n"
        "$(complete -p inertia | sed 's/.*-F \\([^ ]*\\).*/\\1/')\nprintf '%s\\n' \"${COMPREPLY[@]}\"\n"
    )
    done = subprocess.run(
        ["bash", "--norc", "--noprofile"],
        input=script("bash", capsys) + ask,
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=True,
    )
    assert set(done.stdout.split()) == offered


FILES = [("analyse p", "part.stl"), ("balance p", "part.stl"), ("balance measure s", "scene.toml")]


@pytest.mark.skipif(shutil.which("fish") is None, reason="there is no fish")
@pytest.mark.parametrize(
    ("words", "offered"), [("sim", "simulate"), ("balance measure --cert", "--certificate"), *FILES]
)
def test_fish_offers(words: str, offered: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name in ("part.stl", "scene.toml"):
        (tmp_path / name).touch()
    (tmp_path / "complete.fish").write_text(script("fish", capsys))
    ask = f"source complete.fish; complete -C 'inertia {words}'"
    done = subprocess.run(
        ["fish", "--no-config", "-c", ask],
        cwd=tmp_path,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        check=True,
    )
    assert [line.split("\t")[0] for line in done.stdout.splitlines()] == [offered]


@pytest.mark.skipif(shutil.which("zsh") is None, reason="there is no zsh")
def test_zsh_takes_the_script(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "_inertia").write_text(script("zsh", capsys))
    ask = "autoload -Uz compinit && compinit -D -u && source ./_inertia && compdef _shtab_inertia inertia"
    ask += " && print $_comps[inertia]"
    done = subprocess.run(["zsh", "-f", "-c", ask], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "_shtab_inertia"


@pytest.mark.parametrize("shell", SHELLS)
def test_every_command_and_option_is_in_the_script(shell: str, capsys: pytest.CaptureFixture[str]) -> None:
    text = script(shell, capsys)
    for word in ("analyse", "balance", "batch", "cite", "tessellated", "plot-kind"):
        assert word in text
    assert "balance measure" not in text


def test_another_shell_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as leaving:
        main(["completion", "csh"])
    assert leaving.value.code == 2
    assert "choose from" in capsys.readouterr().err
