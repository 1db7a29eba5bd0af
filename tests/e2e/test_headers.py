"""The pages under the policy they are served with: everything on them works, and nothing complains."""

from __future__ import annotations

import asyncio
from collections.abc import Iterator
from pathlib import Path
from urllib.request import Request, urlopen

import pytest
from playwright.async_api import Browser, BrowserContext, Page, expect

from fapstream.server.http import PAGE_POLICY
from tests.benchmarks.server import server
from tests.e2e.pages import until

PHOTOS = Path(__file__).parents[1] / "unit/adapters/photos"
SLOW_MS = 30_000
WATCH = """
window.violations = [];
document.addEventListener("securitypolicyviolation", (e) =>
  window.violations.push(`${e.violatedDirective}: ${e.blockedURI} ${e.sample}`));
"""


@pytest.fixture(scope="module")
def here() -> Iterator[str]:
    with server() as (address, _):
        yield address


async def watched(context: BrowserContext, url: str) -> tuple[Page, list[str]]:
    """A page, and what it and the browser complain of."""
    page = await context.new_page()
    complaints: list[str] = []
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.on("console", lambda said: complaints.append(said.text) if said.type == "error" else None)
    page.on("requestfailed", lambda request: complaints.append(f"failed: {request.url}"))
    await page.add_init_script(WATCH)
    response = await page.goto(url)
    assert response
    assert response.headers["content-security-policy"] == PAGE_POLICY
    return page, complaints


async def content(page: Page, complaints: list[str]) -> None:
    assert await page.evaluate("window.violations") == []
    assert complaints == []


async def test_the_page_speaks(browser: Browser, here: str) -> None:
    """Connected, a head drawn with its texture, the sound worklet at work."""
    page, complaints = await watched(await browser.new_context(), f"http://{here}/")
    await expect(page.locator("#status")).to_contain_text("fapstream", timeout=SLOW_MS)
    await page.locator("#text").fill("Hello world.")
    await page.locator("#speak").click()
    await expect(page.locator("[data-of=latency]")).to_contain_text("ms", timeout=SLOW_MS)
    await expect(page.locator("#stop")).to_be_disabled(timeout=SLOW_MS)
    await content(page, complaints)


async def test_the_editor_makes_a_head(browser: Browser, here: str) -> None:
    """Photos are decoded and shown, a head goes from a blob to the screen and to a file."""
    page, complaints = await watched(await browser.new_context(), f"http://{here}/adapt")
    await expect(page.get_by_text("Connected")).to_be_visible(timeout=SLOW_MS)
    await page.locator("#front .drop input").set_input_files(str(PHOTOS / "person601.front.jpg"))
    await expect(page.locator("#front .count")).to_contain_text("points", timeout=SLOW_MS)
    await page.get_by_role("button", name="Make the head").click()
    await expect(page.get_by_role("button", name="Save head")).to_be_visible(timeout=SLOW_MS)
    async with page.expect_download():
        await page.get_by_role("button", name="Save head").click()
    await page.get_by_role("button", name="Speak").click()
    await asyncio.sleep(1.0)
    await content(page, complaints)


@pytest.mark.parametrize(
    ("smuggled", "directive"),
    [
        ("document.body.append(Object.assign(document.createElement('script'), {text: '1'}))", "script-src"),
        ("document.body.insertAdjacentHTML('beforeend', '<p style=\"color: red\">x')", "style-src"),
        ("document.body.append(Object.assign(new Image(), {src: 'https://evil.example/x.png'}))", "img-src"),
        ("fetch('https://evil.example/').catch(() => 0)", "connect-src"),
    ],
)
async def test_what_was_smuggled_in_does_nothing(
    browser: Browser, here: str, smuggled: str, directive: str
) -> None:
    """That the policy is heeded, else the other tests would say nothing."""
    page, _ = await watched(await browser.new_context(), f"http://{here}/")
    await page.evaluate(f"() => {{ {smuggled}; }}")
    await until(page, "window.violations.length > 0")
    assert directive in (await page.evaluate("window.violations"))[0]


async def test_a_page_elsewhere_cannot_frame_ours_and_may_load_the_head(
    browser: Browser, here: str, elsewhere: tuple[Path, str]
) -> None:
    folder, origin = elsewhere
    (folder / "page.html").write_text(
        f"""<!doctype html><link rel="icon" href="data:,"><iframe src="http://{here}/"></iframe>
        <script type="module" src="http://{here}/fap-head.js"></script>""",
        encoding="utf-8",
    )
    page = await (await browser.new_context()).new_page()
    refused = page.wait_for_event("console", lambda said: "frame-ancestors" in said.text)
    waiting = asyncio.create_task(refused)
    await page.goto(f"{origin}/page.html")
    await waiting
    await page.wait_for_function("() => customElements.get('fap-head')")
    size = f"fetch('http://{here}/heads/generic.glb').then((r) => r.arrayBuffer()).then((b) => b.byteLength)"
    assert await page.evaluate(size) > 100_000


@pytest.mark.parametrize("path", ["/", "/adapt", "/fap-head.js", "/heads/generic.glb"])
def test_plain_requests_are_answered(here: str, path: str) -> None:
    with urlopen(Request(f"http://{here}{path}")) as answer:
        assert answer.headers["X-Content-Type-Options"] == "nosniff"
        assert answer.headers.get_all("Content-Security-Policy")
