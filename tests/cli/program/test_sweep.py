"""Many values: combinations, threads, processes."""

import json

import pytest
from program import PENDULUM, columns, model, run, table

SWEEP = ["sweep", PENDULUM, "--to", "2"]


def test_range_has_the_numbers_that_are_meant():
    names, rows = table(run(*SWEEP, "--set", "L=0.5:0.1:2", "--variables", "x,energy").stdout)
    assert names == ["instance", "L", "outcome", "time", "x", "energy"]
    assert [row[1] for row in rows] == [repr(round(0.5 + 0.1 * k, 1)).removesuffix(".0") for k in range(16)]
    assert [row[0] for row in rows] == [str(k + 1) for k in range(16)]
    assert {row[2] for row in rows} == {"solved"} and {row[3] for row in rows} == {"2"}


def test_descending_ranges_lists_and_combinations():
    _, rows = table(run(*SWEEP, "--set", "L=3:-1:1", "--set", "g=9.81,1.62", "--variables", "x").stdout)
    assert [row[1:3] for row in rows] == [[length, g] for length in ("3", "2", "1") for g in ("9.81", "1.62")]


def test_instances_are_what_solve_computes():
    _, rows = table(run(*SWEEP, "--set", "g=1.62,9.81", "--variables", "x,y").stdout)
    for row in rows:
        solution = columns(run("solve", PENDULUM, "--to", "2", "--outputs", "1", "--set", f"g={row[1]}").stdout)
        assert [float(v) for v in row[-2:]] == [solution["x"][-1], solution["y"][-1]]


def test_results_do_not_depend_on_threads():
    arguments = [*SWEEP, "--set", "L=0.5:0.25:2", "--set", "g=1.62,9.81"]
    alone = run(*arguments, "--jobs", "1").stdout
    assert run(*arguments, "--jobs", "2").stdout == alone
    assert run(*arguments, "--jobs", "5").stdout == alone


RANKS = [("OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE"), ("PMI_RANK", "PMI_SIZE"), ("SLURM_PROCID", "SLURM_STEP_NUM_TASKS")]


@pytest.mark.parametrize("rank_name, size_name", RANKS)
def test_processes_share_the_instances(rank_name, size_name, tmp_path):
    arguments = [*SWEEP, "--set", "L=1:0.25:2"]
    head, whole = table(run(*arguments).stdout)
    parts = []
    for rank in range(3):
        environment = {rank_name: str(rank), size_name: "3"}
        run(*arguments, "--csv", tmp_path / "o.csv", "--json", tmp_path / "o.json", environment=environment)
        names, rows = table((tmp_path / f"o.rank{rank}.csv").read_text())
        assert names == head
        parts += rows
        data = json.loads((tmp_path / f"o.rank{rank}.json").read_text())
        assert [i["instance"] for i in data["instances"]] == [int(row[0]) for row in rows]
    assert sorted(parts, key=lambda row: int(row[0])) == whole


def test_one_process_writes_the_names():
    arguments = [*SWEEP, "--set", "L=1,2,3"]
    outputs = [run(*arguments, environment={"PMI_RANK": str(rank), "PMI_SIZE": "2"}).stdout for rank in range(2)]
    assert outputs[0].startswith("instance,") and outputs[1].startswith("2,2,solved")


def test_more_processes_than_instances():
    arguments = [*SWEEP, "--set", "L=1,2"]
    assert run(*arguments, environment={"PMI_RANK": "2", "PMI_SIZE": "4"}).stdout == ""


def test_batch_script_of_slurm_is_no_process_of_several():
    _, rows = table(run(*SWEEP, "--set", "L=1,2", environment={"SLURM_PROCID": "0", "SLURM_NTASKS": "2"}).stdout)
    assert len(rows) == 2


def test_outputs_over_time():
    names, rows = table(run(*SWEEP, "--set", "L=1,2", "--outputs", "4", "--variables", "x").stdout)
    assert [row[names.index("time")] for row in rows] == ["0", "0.5", "1", "1.5", "2"] * 2


def test_failed_instances_are_named(tmp_path):
    # x = 1 / (1 / x0 - t) ends at 1 / x0.
    path = model(tmp_path, "    parameter Real 'x0' = 1.0;\n    Real 'x'(start = 'x0', fixed = true);",
                 "    der('x') = 'x' ^ 2;")
    result = run("sweep", path, "--to", "1", "--set", "x0=0.5,2,0.25", "--json", tmp_path / "s.json", "--csv", "-", code=1)
    assert "instance 2 is not finished" in result.stderr
    names, rows = table(result.stdout)
    assert [row[names.index("outcome")] for row in rows] == ["solved", "not finished", "solved"]
    assert float(rows[0][-1]) == pytest.approx(1.0, rel=1e-4)
    instances = json.loads((tmp_path / "s.json").read_text())["instances"]
    assert instances[1]["status"] != "SFDAE_OK" and instances[1]["message"] and instances[2]["message"] == ""


def test_warnings_of_instances_are_kept(tmp_path):
    path = model(tmp_path, "    parameter Real 'k' = 1.0;\n    Real 'x'(start = 0.0, fixed = true, max = 1.5);",
                 "    der('x') = 'k';")
    run("sweep", path, "--to", "1", "--set", "k=1,2", "--json", tmp_path / "s.json")
    first, second = json.loads((tmp_path / "s.json").read_text())["instances"]
    assert first["warnings"] == [] and "above max = 1.5" in second["warnings"][0]


def test_warnings_name_the_first_instance_that_has_them(tmp_path):
    path = model(tmp_path, "    parameter Real 'p'(max = 20) = 1;\n    Real 'x'(start = 1.0);\n"
                           "    Real 'y'(start = 1.0, fixed = true);", "    der('y') = 0;\n    'x' = 'p' * 'y';")
    result = run("sweep", path, "--set", "p=19:24", "--set", "x=20,21")
    lines = result.stderr.splitlines()
    assert [line[:21] for line in lines if "parameter p is 21, above max = 20" in line] == ["warning: instance 5: "], lines
    assert len(lines) == 11 and lines[-1] == "warning: ... and 4 more; --json FILE has all", lines
    assert run("sweep", path, "--set", "p=19:24", "--set", "x=20,21", "--quiet").stderr == ""
