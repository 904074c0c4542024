"""Every code sample of the README and the guides has a test that runs it, or is named here as what only runs elsewhere."""

import pytest

from tests.guides import PAGES, ROOT, samples

# page -> the tests that run its samples, or for pages of builders the test of the builder
RUN_BY = {
    "README.md": "drill/test_guides.py",
    "docs/self_study.md": "drill/test_guides.py",
    "notebooks/README.md": "drill/test_guides.py",
    "docs/student.md": "drill/test_student_guide.py",
    "autograder/templates/bundle/README.md": "drill/test_student_guide.py",
    "docs/instructor.md": "drill/test_instructor_guide.py",
}
KINDS = {("sh", ""), ("sh", "stays"), ("sh", "cluster"), ("python", ""), ("ipython", "colab")}
ELSEWHERE = {("docs/student.md", "powershell"): 1}  # Windows only: read, and compared with the commands for other systems


@pytest.mark.parametrize("page", PAGES)
def test_each_sample_of_a_page_is_run_or_named(page):
    found = samples(page)
    foreign = [s.language for s in found if (s.language, s.kind) not in KINDS]
    named = {language: count for (where, language), count in ELSEWHERE.items() if where == page}
    assert {language: foreign.count(language) for language in foreign} == named
    if found:
        assert f'"{page}"' in (ROOT / "tests" / RUN_BY[page]).read_text()


def test_no_fence_escapes_the_search():
    for page in PAGES:
        fences = [line for line in (ROOT / page).read_text().splitlines() if line.strip().startswith("```")]
        assert len(fences) == 2 * len(samples(page)), page


def test_windows_and_other_systems_are_told_the_same():
    unix, windows = (next(s.text for s in samples("docs/student.md") if s.language == kind) for kind in ("sh", "powershell"))
    same = windows.replace("py -m", "python3 -m").replace(".venv\\Scripts\\Activate.ps1", ". .venv/bin/activate")
    assert same == unix
