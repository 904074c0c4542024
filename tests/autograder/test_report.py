"""Pages, index and grades, of results as the grader writes them and as a stranger would like them."""

import csv
import json
import re
import time
import tracemalloc
from base64 import b64decode
from hashlib import sha256
from html.parser import HTMLParser

import pytest
from PIL import Image
from report_samples import EVIL, MISTAKE, check, page_of, paint, poison, result, sample_checks, store

from autograder.report import write_grades, write_index, write_page
from autograder.report_view import CHECK_WORDS, PICTURE_BYTES, SUBMISSION_WORDS, number, text


class Reader(HTMLParser):
    """Collects the tags, attributes and text that a browser would see."""

    def __init__(self, page):
        super().__init__()
        self.tags, self.attributes, self.words = [], [], []
        self.feed(page)
        self.text = " ".join(" ".join(self.words).split())

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        self.attributes += [(tag, name, value or "") for name, value in attrs]

    def handle_data(self, data):
        self.words.append(data)


def test_markup_in_every_text_of_a_result_stays_text(tmp_path):
    data = poison(result(checks=[{**c, "images": {"yours": "a.png"}} for c in sample_checks()]))
    data |= {"status": "graded", "schema": 1}
    data["checks"][5]["traceback"] = data["checks"][5]["prints"] = EVIL
    path = tmp_path / "results" / "evil" / "sphere_tracing.json"
    path.parent.mkdir(parents=True)
    path.write_text(json.dumps(data))
    page = Reader(write_page(data, path, tmp_path).read_text(encoding="utf-8"))
    write_index(tmp_path)
    index = Reader((tmp_path / "index.html").read_text(encoding="utf-8"))
    assert page.tags.count("script") == index.tags.count("script") == 1
    for read in (page, index):
        assert EVIL[:60] in read.text and "{{ 7*7 }}&lt;b&gt;" in read.text
        assert not [a for a in read.attributes if a[1].startswith("on") or a[1] == "style"]
        assert all(value.startswith("data:") for tag, name, value in read.attributes if name == "src")


def test_the_policy_lets_nothing_run_but_the_pages_own_style_and_script(tmp_path):
    page_of(tmp_path, result(checks=sample_checks()))
    write_index(tmp_path)
    for path in (tmp_path / "pages/amy/sphere_tracing.html", tmp_path / "index.html"):
        html = path.read_text(encoding="utf-8")
        policy = re.search(r'Content-Security-Policy" content="([^"]*)"', html)[1].replace("&#39;", "'")
        assert "default-src 'none'" in policy and "unsafe" not in policy
        for tag in ("style", "script"):
            for block in re.findall(rf"<{tag}>(.*?)</{tag}>", html, re.S):
                digest = re.search(rf"{tag}-src 'sha256-([^']*)'", policy)[1]
                assert b64decode(digest) == sha256(block.encode()).digest()


@pytest.mark.parametrize(
    "student", ['O"Neill <&>', "日本語 名前", "x" * 5000, "a\u202eb\x00\x1b[31m\ud800", "=1+1", " "]
)
def test_odd_names_are_shown_and_never_reorder_what_is_around_them(tmp_path, student):
    page = page_of(tmp_path, result(student, checks=sample_checks()), folder="folder-1f2e")
    write_index(tmp_path)
    write_grades(tmp_path)
    index = (tmp_path / "index.html").read_text(encoding="utf-8")
    shown = " ".join(text(student, 200).split())
    assert shown in Reader(page).text and shown in Reader(index).text
    assert not {"\u202e", "\x00", "\x1b"} & set(page + index)
    assert len(page) < 100_000


@pytest.mark.parametrize("status", SUBMISSION_WORDS)
def test_every_submission_status_has_a_page_that_says_it(tmp_path, status):
    html = page_of(tmp_path, result(status=status, message="told by the grader"))
    assert SUBMISSION_WORDS[status] in html and "told by the grader" in html


def test_every_check_status_has_a_word_a_meaning_and_a_shape_of_its_own(tmp_path):
    html = page_of(tmp_path, result(checks=sample_checks()))
    cards = re.findall(r'<section class="card (.*?)</section>', html, re.S)
    assert len(cards) == len(CHECK_WORDS)
    seen = {re.match(r"s-(\w+)", card)[1]: card for card in cards}
    assert set(seen) == set(CHECK_WORDS)
    for status, (word, meaning) in CHECK_WORDS.items():
        assert f"<strong>{word}</strong>" in seen[status] and meaning in seen[status]
        assert f'<use href="#{status}"/>' in seen[status] and f'<symbol id="{status}"' in html
    shapes = re.findall(r'<symbol id="\w+" viewBox="0 0 20 20">(.*?)</symbol>', html)
    assert len(shapes) == len(set(shapes)) == len(CHECK_WORDS) + 2


def test_a_page_tells_score_errors_mistake_and_what_would_raise_the_score_most(tmp_path):
    page = Reader(page_of(tmp_path, result(checks=sample_checks())))
    assert "3.16 of 22 points" in page.text
    gains = page.text.split("raise the score")[1]
    assert re.match(
        r" 1\.7 sphere_trace Timeout up to \+5 1\.6 estimate_normal Error up to \+4 1\.3 sdf_torus Fail up to \+3",
        gains,
    )
    for words in ("box without interior term", "The distance is 0 everywhere inside.", "Add min(max(q.x", "limit 1×10⁻⁹",
                  "missed on hidden inputs",
                  "rms 0.0213 2.13 × the limit of 0.01", "0.24 of 0.6", "11.23 × the reference's 81 234",
                  "notebook 9f2c", "versions numpy 2.4.0"):  # fmt: skip
        assert words in page.text, words


def test_an_error_lies_on_the_scale_by_its_decades_from_the_limit(tmp_path):
    errors = {
        1e-12: 6.0,
        1e-4: 44.0,
        1e-2: 120.0,
        1.0: 196.0,
        1e9: 234.0,
        0.0: 6.0,
    }  # of 6 to 234, limit 1e-2
    checks = [check(str(i), "f", metric="rms", error=error, tolerance=1e-2) for i, error in enumerate(errors)]
    html = page_of(tmp_path, result(checks=checks))
    marks = re.findall(r'class="(within|outside)" (?:cx="|d="M)([\d.]+)', html)[: len(errors)]
    assert [float(x) for _, x in marks] == list(errors.values())
    assert [kind for kind, _ in marks] == ["within"] * 3 + ["outside"] * 2 + ["within"]


@pytest.mark.parametrize(
    "level, loud", [("namespaces+seccomp", False), ("subprocess", True), ("", True), (None, True)]
)
def test_weak_isolation_is_said_loudly(tmp_path, level, loud):
    html = page_of(tmp_path, result(isolation=level))
    write_index(tmp_path)
    assert ("NOT ISOLATED" in html) == loud == ("NOT ISOLATED" in (tmp_path / "index.html").read_text())


def test_pictures_travel_inside_the_page_at_a_whole_zoom(tmp_path):
    images = paint(tmp_path / "pages/amy/sphere_tracing", "1.2", size=64)
    html = page_of(
        tmp_path, result(checks=[check("1.2", "sdf_box", "partial", 1, 3, **MISTAKE, images=images)])
    )
    found = re.findall(r'src="data:image/png;base64,([^"]*)" width="(\d+)" height="(\d+)"', html)
    assert [(w, h) for _, w, h in found] == [("384", "384")] * 3  # 64 pixels, six times
    files = [
        (tmp_path / "pages/amy/sphere_tracing" / name.rsplit("/")[-1]).read_bytes()
        for name in images.values()
    ]
    assert [b64decode(data) for data, _, _ in found] == files
    assert 'aria-label="Colours run from −0.25, too small, over 0 to 0.25, too large"' in html


def test_a_page_stays_below_two_megabytes_and_keeps_the_pictures_of_the_dearest_mistake(tmp_path):
    folder = tmp_path / "pages/amy/sphere_tracing"
    checks = [
        check(f"1.{i}", "f", "fail", 0, i, images=paint(folder, f"1.{i}", 256, noise=1.0))
        for i in range(1, 8)
    ]
    assert sum(path.stat().st_size for path in folder.iterdir()) > PICTURE_BYTES
    html = page_of(tmp_path, result(checks=checks))
    assert len(html) < 2_000_000
    cards = re.findall(r'id="task-(1\.\d)"(.*?)</section>', html, re.S)
    assert [len(re.findall("base64,", card)) for task, card in cards if task == "1.7"] == [3]
    assert 'href="sphere_tracing/1.1-yours.png"' in html


@pytest.mark.parametrize(
    "name", ["../../../secret.png", "/etc/hostname", "../../pages/amy/x/none.png", "x\0y", "../../pages"]
)
def test_only_pictures_below_pages_are_read(tmp_path, name):
    out = tmp_path / "out"
    Image.new("RGB", (4, 4)).save(tmp_path / "secret.png")
    html = page_of(out, result(checks=[check("1.1", "f", images={"yours": name})]))
    assert "base64," not in html and "This picture is missing" in html


def test_a_foreign_or_broken_file_gets_a_row_and_stops_nothing(tmp_path):
    store(tmp_path, result("amy", checks=sample_checks()))
    folder = tmp_path / "results" / "bob"
    folder.mkdir()
    broken = {"a": b"{", "b": b"\xff\xfe\x00", "c": b"[" * 100_000, "d": b'{"schema": 1}', "e": b"null",
              "f": b"",
              "g": json.dumps(result() | {"score": True}).encode(), "h": b'{"schema": 1' + b"1" * 5000 + b"}",
              "i": json.dumps(result() | {"score": float("nan")}).encode(),
              "j": json.dumps(result() | {"status": ["graded"]}).encode()}  # fmt: skip
    for name, data in broken.items():
        (folder / f"{name}.json").write_bytes(data)
    (folder / "k.json").symlink_to(tmp_path / "results" / "amy" / "sphere_tracing.json")
    (folder / "l.json").mkdir()
    write_index(tmp_path)
    write_grades(tmp_path)
    assert (tmp_path / "index.html").read_text().count(">unreadable</td>") == 12
    rows = list(csv.reader((tmp_path / "grades.csv").open(newline="")))
    assert rows[1][:3] == ["amy", "sphere_tracing", "graded"] and rows[2] == [
        "bob",
        "a",
        "unreadable",
        "",
        "",
    ]
    assert len(rows) == 14
    for name in "de":
        with pytest.raises(ValueError, match="not a grader's result"):
            write_page(json.loads(broken[name]), folder / f"{name}.json", tmp_path)


def test_odd_values_inside_a_result_are_left_empty(tmp_path):
    odd = [None, -1, 1e308, float("nan"), float("inf"), 10**400, "7", [], {}, True]
    keys = ["error", "tolerance", "evaluations", "evaluations_reference", "measures", "images", "scale",
            "traceback", "prints", "caption", "message", "likely_mistake", "symptom", "hint", "metric"]  # fmt: skip
    checks = [check(str(i), "f", **{key: value for key in keys}) for i, value in enumerate(odd)]
    checks += [
        check("x", "f", measures=[dict.fromkeys(["error", "tolerance", "share", "credit"], v)]) for v in odd
    ]
    checks += [
        check("y", "f", measures=[{"error": e, "tolerance": t}])
        for e in (1e308, 0, -1)
        for t in (0, 1e-308, -1)
    ]
    html = page_of(tmp_path, result(checks=checks, record=odd))
    assert not re.search(r"\b(nan|inf)\b", Reader(html).text.replace("NaN", ""))
    assert number(10**400) is None and number(True) is None


def test_the_table_of_grades_is_sorted_and_runs_no_formula(tmp_path):
    students = [" zoe", "=cmd|' /C calc'!A0", "+1", "-1", "@SUM(A1)", "\tx", "\rx", 'a,b"c', "amy", "日本"]
    for i, student in enumerate(students):
        store(tmp_path, result(student, checks=[check("1.1", "f", score=1.25)]), f"s{i}")
    store(tmp_path, result("amy", "soft_shadows", [check("2.1", "f")]), folder="s8")
    write_grades(tmp_path)
    with (tmp_path / "grades.csv").open(encoding="utf-8", newline="") as file:
        assert file.readline() == "student,assignment,status,score,max_score\n"
        rows = list(csv.reader(file))
    assert rows == sorted(rows) and len(rows) == 11
    assert ["'=cmd|' /C calc'!A0", "sphere_tracing", "graded", "1.25", "2"] in rows
    assert {row[0][0] for row in rows} == {"'", "a", " ", "日"} and sum(row[0][0] == "'" for row in rows) == 6
    assert ["'\rx", "sphere_tracing", "graded", "1.25", "2"] in rows


def test_the_index_counts_statuses_means_and_tasks(tmp_path):
    store(tmp_path, result("amy", checks=[check("1.1", "f", score=1), check("1.2", "g", score=2)]))
    store(tmp_path, result("bob", checks=[check("1.1", "f", score=0), check("1.2", "g", score=2)]))
    store(tmp_path, result("cy", status="rejected", message="not a notebook"))
    write_page(json.loads((tmp_path / "results/amy/sphere_tracing.json").read_text()),
               tmp_path / "results/amy/sphere_tracing.json", tmp_path)  # fmt: skip
    write_index(tmp_path)
    html = (tmp_path / "index.html").read_text()
    read = Reader(html)
    assert "Submissions 3 Mean score 62 %" in read.text  # (3/4 + 2/4) / 2
    assert "Sphere tracing 2 graded 2.5 of 4 1.1 25 % 1.2 100 %" in read.text
    assert [value for tag, name, value in read.attributes if tag == "a" and name == "href"] == [
        "#submissions", "pages/amy/sphere_tracing.html"]  # fmt: skip


def test_files_are_written_whole_or_not_at_all(tmp_path, monkeypatch):
    store(tmp_path, result(checks=sample_checks()))
    write_index(tmp_path)
    write_grades(tmp_path)
    before = {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()}
    assert {path.name for path in before} == {"sphere_tracing.json", "index.html", "grades.csv"}
    monkeypatch.setattr("os.replace", lambda *paths: (_ for _ in ()).throw(OSError("disk gone")))
    for write in (write_index, write_grades):
        with pytest.raises(OSError, match="disk gone"):
            write(tmp_path)
    assert {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()} == before


def test_the_same_results_give_the_same_bytes_in_any_directory(tmp_path):
    written = []
    for name in ("a", "b"):
        out = tmp_path / name
        images = paint(out / "pages/amy/sphere_tracing", "1.2", size=16)
        page_of(out, result(checks=[{**c, "images": images} for c in sample_checks()]))
        store(out, result("bob", "soft_shadows"))
        write_index(out)
        write_grades(out)
        written.append({p.relative_to(out): p.read_bytes() for p in out.rglob("*") if p.is_file()})
    assert written[0] == written[1]


def test_memory_stays_flat_and_ten_thousand_results_would_take_less_than_thirty_seconds(tmp_path):
    def spend(count, start):
        body = json.dumps(result("NAME", checks=[{**c, "prints": "x" * 4000} for c in sample_checks()]))
        for i in range(start, count):
            folder = tmp_path / "results" / f"s{i:05d}"
            folder.mkdir(parents=True)
            (folder / "sphere_tracing.json").write_text(body.replace("NAME", folder.name))
        tracemalloc.start()
        write_index(tmp_path)
        write_grades(tmp_path)
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        return peak

    first, second = spend(50, 0), spend(300, 50)
    assert second - first < 250 * 4000  # less than the results themselves: 40 kB each
    start = time.process_time()
    write_index(tmp_path)
    write_grades(tmp_path)
    assert (time.process_time() - start) / 300 * 10_000 < 30
