"""Names and texts may contain anything that the language allows."""

import json

import pytest
from program import model, run, table

NAMES = ['a.b[1,2].c', 'say "hi", <b>', "it\\'s", "</script><script>alert(1)</script>", "a=b", "{{data}}", "x y", "back\\\\slash",
         "$x", "100 %", "&amp;"]
PLAIN = [name.replace("\\'", "'").replace("\\\\", "\\") for name in NAMES]


@pytest.fixture
def strange(tmp_path):
    declarations = "\n".join(f"    Real '{name}'(start = {k}.0, fixed = true, unit = \"m\\\"<\") \"</script>\n&\";"
                             for k, name in enumerate(NAMES))
    equations = "\n".join(f"    der('{name}') = {k}.0;" for k, name in enumerate(NAMES))
    return model(tmp_path, declarations, equations, name="</title> & {{script}}")


def expected(k):
    return [float(k), 2.0 * k]


def test_csv_quotes_names(strange):
    names, rows = table(run("solve", strange, "--to", "1", "--outputs", "1").stdout)
    assert names == ["time", *PLAIN]
    for k, _ in enumerate(PLAIN):
        assert [float(row[k + 1]) for row in rows] == pytest.approx(expected(k))


def test_json_keeps_names(strange, tmp_path):
    run("solve", strange, "--to", "1", "--outputs", "1", "--json", tmp_path / "r.json", "--html", tmp_path / "r.html")
    data = json.loads((tmp_path / "r.json").read_text())
    assert [v["name"] for v in data["variables"]] == PLAIN
    assert {v["description"] for v in data["variables"]} == {"</script>\n&"}
    assert data["model"] == "</title> & {{script}}"


def test_page_ends_its_scripts_itself_only(strange, tmp_path):
    run("solve", strange, "--to", "1", "--html", tmp_path / "r.html")
    page = (tmp_path / "r.html").read_text()
    assert page.count("</script") == 2 and page.count("<script") == 2 and page.count("</title>") == 1
    text = page.split('<script type="application/json" id="data">')[1].split("</script>")[0]
    assert [v["name"] for v in json.loads(text)["variables"]] == PLAIN


@pytest.mark.parametrize("name", PLAIN)
def test_names_are_set_and_chosen(strange, name):
    names, rows = table(run("solve", strange, "--to", "1", "--outputs", "1", "--set", f"{name}=7.5", "--variables",
                            f"'{name}'").stdout)
    assert names == ["time", name] and float(rows[0][1]) == 7.5


def test_sweep_quotes_names(strange):
    names, rows = table(run("sweep", strange, "--to", "1", "--set", "say \"hi\", <b>=1,2", "--variables", "a=b").stdout)
    assert names == ["instance", 'say "hi", <b>', "outcome", "time", "a=b"] and len(rows) == 2
