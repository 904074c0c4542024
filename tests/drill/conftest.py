"""What drills share: a real browser."""

from pathlib import Path

import pytest

CHROMIUM = Path("/usr/bin/chromium")


@pytest.fixture(scope="session")
def browser():
    playwright = pytest.importorskip("playwright.sync_api")
    if not CHROMIUM.exists():
        pytest.skip(f"no browser at {CHROMIUM}")
    with playwright.sync_playwright() as session:
        browser = session.chromium.launch(executable_path=str(CHROMIUM), args=["--no-sandbox"])
        yield browser
        browser.close()


@pytest.fixture(scope="session")
def axe():
    """Finds on an open page what breaks axe-core's accessibility rules, in words."""
    package = pytest.importorskip("axe_playwright_python", reason="axe-core is not installed (the dev extra has it)")
    script = Path(package.__file__).with_name("axe.min.js").read_text(encoding="utf-8")

    def findings(page, grave=("serious", "critical")):
        page.evaluate(script)  # through the debugger, which the page's policy does not bind
        found = page.evaluate("axe.run(document, {resultTypes: ['violations']})")
        assert len(found["passes"]) > 10, "axe-core has not run"
        return [
            f"{rule['impact']}, {rule['id']}: {rule['help']}: {node['html'][:160]}"
            for rule in found["violations"]
            if rule["impact"] in grave
            for node in rule["nodes"]
        ]

    return findings
