"""`<fap-head>` in a page: what a page does to it, and what the world does to the page."""

from __future__ import annotations

import asyncio
import os
from pathlib import Path

import numpy as np
from playwright.async_api import Browser, Page, async_playwright

from tests.e2e.conftest import CHROMIUM
from tests.e2e.link import Link
from tests.e2e.pages import embed, visit
from tests.e2e.sound import RATE, Recorder

SAY = "(text) => document.querySelector('#head').speak(text, { lang: 'en' }).finished"
SPEAK_UNASKED = """
addEventListener("load", () => {
  const head = document.querySelector("#head");
  window.end = null;
  const speak = () => {
    head.speak("Hello.").finished.then((e) => (window.end = e));
    setTimeout(() => console.log("asked"), 500);
  };
  if (head.server) speak();
  else head.addEventListener("ready", speak);
});
"""
"""The page itself must speak, and be left alone until it has: what a test evaluates counts as a gesture."""

HIDE_AND_SPEAK = """
async () => {
  const head = document.querySelector("#head");
  Object.defineProperty(document, "hidden", { value: true, configurable: true });
  document.dispatchEvent(new Event("visibilitychange"));
  const canvas = head.shadowRoot.querySelector("canvas");
  const draw = WebGL2RenderingContext.prototype.drawElements;
  let frames = new Set();
  WebGL2RenderingContext.prototype.drawElements = function (...a) {
    if (this.canvas === canvas) frames.add(document.timeline.currentTime);
    return draw.apply(this, a);
  };
  const end = await head.speak("Nobody sees me now.", { lang: "en" }).finished;
  return [frames.size, end.reason];
}
"""

CONNECTED = "document.querySelector('#head').server !== null"


async def open_page(browser: Browser) -> Page:
    return await browser.new_page(viewport={"width": 320, "height": 320})


async def test_a_click_unlocks_the_sound(
    card: dict[str, str], elsewhere: tuple[Path, str], address: str
) -> None:
    """Where autoplay is blocked the element asks for a click, and then says all of it."""
    async with async_playwright() as playwright:
        browser = await playwright.chromium.launch(
            executable_path="/usr/bin/chromium", args=CHROMIUM, env={**os.environ, **card},
            ignore_default_args=["--mute-audio"],
        )  # fmt: skip
        page = await open_page(browser)
        await page.add_init_script(SPEAK_UNASKED)
        recorder = Recorder(card)
        async with page.expect_console_message(lambda message: message.text == "asked"):
            await visit(page, elsewhere, address, address)
        button = page.locator("#head .unlock")
        await button.wait_for(state="visible")
        assert not (np.abs(recorder.heard_so_far().astype(int)) > 300).any()
        await button.click()
        await page.wait_for_function("window.end !== null")
        await asyncio.sleep(0.3)
        assert (np.abs(recorder.stop().pcm.astype(int)) > 300).any()
        assert not await button.is_visible()
        await browser.close()


async def test_removed_and_put_back(browser: Browser, elsewhere: tuple[Path, str], address: str) -> None:
    """Twenty times; no connection is left behind, and it still speaks."""
    page = await open_page(browser)
    async with Link(address) as link:
        await embed(page, elsewhere, address, link.address)
        for _ in range(20):
            await page.evaluate(
                "() => { window.kept = document.querySelector('#head'); window.kept.remove(); }"
            )
            await page.evaluate("() => document.body.append(window.kept)")
        await page.wait_for_function(CONNECTED)
        await asyncio.sleep(1.0)
        assert link.joined == 1
        assert (await page.evaluate(SAY, "Here again."))["reason"] == "end"
        assert (
            await page.evaluate(
                "document.querySelector('#head').shadowRoot.querySelectorAll('canvas').length"
            )
            == 1
        )
        await page.evaluate("document.querySelector('#head').remove()")
        await asyncio.sleep(0.5)
        assert link.joined == 0


async def test_several_heads_on_one_page(browser: Browser, elsewhere: tuple[Path, str], address: str) -> None:
    """Each speaks its own text with its own voice; the sound processor and the head file are shared."""
    page = await open_page(browser)
    await embed(page, elsewhere, address, address)
    fetched: list[str] = []
    page.on("request", lambda request: fetched.append(request.url))
    ends = await page.evaluate(
        """async () => {
          const twin = document.querySelector("#head").cloneNode();
          twin.id = "twin";
          document.body.append(twin);
          if (!twin.server) await new Promise((go) => twin.addEventListener("ready", go, { once: true }));
          const say = (id, text, lang) => document.querySelector(id).speak(text, { lang }).finished;
          return Promise.all([say("#head", "One head.", "en"), say("#twin", "Δύο κεφάλια.", "el")]);
        }"""
    )
    assert [e["reason"] for e in ends] == ["end", "end"]
    assert not [url for url in fetched if url.endswith((".glb", "worklet.js"))]


async def test_it_connects_again(browser: Browser, elsewhere: tuple[Path, str], address: str) -> None:
    """A cut connection is told, and soon there is another, over which the turn goes on to its end."""
    page = await open_page(browser)
    async with Link(address) as link:
        await embed(page, elsewhere, address, link.address)
        await page.evaluate(
            """() => {
              const head = document.querySelector("#head");
              window.lost = 0;
              head.addEventListener("disconnected", () => window.lost++);
              window.outcome = head.speak("This will be heard to its end, come what may.")
                .finished.then(() => "finished", (e) => e.code ?? String(e));
            }"""
        )
        await asyncio.sleep(1.0)
        link.cut()
        await page.wait_for_function("window.lost > 0")
        assert await page.evaluate("window.outcome") == "finished"
        await page.wait_for_function(CONNECTED, timeout=15_000)
        assert (await page.evaluate(SAY, "Here again."))["reason"] == "end"


async def test_interrupt_tells_what_was_heard(
    browser: Browser, elsewhere: tuple[Path, str], address: str, card: dict[str, str]
) -> None:
    """Silence soon after; the count of characters ends a word that was heard."""
    page = await open_page(browser)
    await embed(page, elsewhere, address, address)
    text = "This sentence is rather long, so that it can be interrupted in its middle without any trouble."
    recorder = Recorder(card)
    end = await page.evaluate(
        """async (text) => {
          const head = document.querySelector("#head");
          const turn = head.speak(text, { lang: "en" });
          turn.finished.catch(() => 0);
          await new Promise((go) => setTimeout(go, 1500));
          return head.interrupt();
        }""",
        text,
    )
    await asyncio.sleep(0.6)
    pcm = recorder.stop().pcm
    assert end["reason"] == "interrupted"
    assert 5 < end["char"] < len(text)
    assert not text[end["char"]].isalpha()
    tail = np.abs(pcm[-len(pcm) // 10 :].astype(int))
    assert tail.max() < 300


async def test_an_interrupt_is_heard_at_once(
    browser: Browser, elsewhere: tuple[Path, str], address: str, card: dict[str, str]
) -> None:
    """From the page's call to silence at the ear, with fade and sound card; asserted with a margin."""
    page = await open_page(browser)
    await embed(page, elsewhere, address, address)
    recorder = Recorder(card)
    called = []
    for _ in range(5):
        called.append(
            await page.evaluate(
                """async () => {
                  const head = document.querySelector("#head");
                  const turn = head.speak("Ah, are you all aware how long a road it is?", { lang: "en" });
                  turn.finished.catch(() => 0);
                  await new Promise((go) => setTimeout(go, 1100));
                  const at = Date.now() / 1000;
                  await head.interrupt();
                  return at;
                }"""
            )
        )
        await asyncio.sleep(0.5)
    recording = recorder.stop()
    loud = np.abs(recording.pcm.astype(int)) > 200
    delays_ms = []
    for at in called:
        first = round((at - recording.start) * RATE)
        after = np.flatnonzero(loud[first : first + RATE // 3])
        delays_ms.append(1000 * (after[-1] if len(after) else 0) / RATE)
    print(f"silent {np.median(delays_ms):.0f} ms after the call (most {max(delays_ms):.0f} ms)")
    assert np.median(delays_ms) < 120


async def test_it_follows_its_size(browser: Browser, elsewhere: tuple[Path, str], address: str) -> None:
    """The picture has the element's size in the screen's own pixels, and changes with it."""
    page = await open_page(browser)
    await embed(page, elsewhere, address, address)
    size = "(() => { const c = document.querySelector('#head').shadowRoot.querySelector('canvas');"
    assert await page.evaluate(f"{size} return [c.width, c.height]; }})()") == [320, 320]
    await page.evaluate("document.querySelector('#head').style.cssText = 'width:200px;height:160px'")
    await page.wait_for_function(f"{size} return c.width === 200 && c.height === 160; }})()")


async def test_a_hidden_page_speaks_on(browser: Browser, elsewhere: tuple[Path, str], address: str) -> None:
    """Nothing is drawn while nobody can see it; the turn is heard to its end all the same."""
    page = await open_page(browser)
    await embed(page, elsewhere, address, address)
    drawn, reason = await page.evaluate(HIDE_AND_SPEAK)
    assert reason == "end"
    assert drawn <= 1


async def test_reduced_motion_keeps_still(
    browser: Browser, elsewhere: tuple[Path, str], address: str
) -> None:
    """Idle, the face lives; where the user wants less motion, no pixel changes."""
    changed = {}
    for wish in ("no-preference", "reduce"):
        page = await open_page(browser)
        await page.emulate_media(reduced_motion=wish)  # type: ignore[arg-type]
        await embed(page, elsewhere, address, address)
        await asyncio.sleep(1.5)
        shots = []
        for _ in range(4):
            shots.append(await page.screenshot())
            await asyncio.sleep(0.7)
        changed[wish] = len(set(shots)) > 1
        await page.close()
    assert changed == {"no-preference": True, "reduce": False}


async def test_an_insecure_page_is_told(browser: Browser, elsewhere: tuple[Path, str], address: str) -> None:
    """Without a secure context there is no AudioWorklet: the element says so."""
    page = await open_page(browser)
    await page.add_init_script("Object.defineProperty(window, 'isSecureContext', { value: false })")
    await embed(page, elsewhere, address, address)
    message = page.locator("#head .message")
    await message.wait_for(state="visible")
    assert "secure context" in await message.inner_text()


async def test_a_head_that_cannot_be_shown_leaves_the_one_that_is(
    browser: Browser, elsewhere: tuple[Path, str], address: str
) -> None:
    """The page says which file and why; the next good head takes the message away."""
    page = await open_page(browser)
    await embed(page, elsewhere, address, address)
    (elsewhere[0] / "cut.glb").write_bytes(b"glTF" + bytes(100))
    await page.evaluate(
        "() => { head = document.querySelector('#head'); said = head.shadowRoot.querySelector('.message'); }"
    )
    for name, reason in (
        ("cut.glb", "/cut.glb: GLB header"),
        ("nobody", "/nobody.glb: HTTP 404"),
        ("http://", "http:// cannot be reached"),
    ):
        await page.evaluate("(name) => head.setAttribute('head', name)", name)
        await page.wait_for_function("(r) => !said.hidden && said.textContent.includes(r)", arg=reason)
    picture = await page.evaluate("head.shadowRoot.querySelector('canvas').toDataURL().length")
    assert picture > 20_000, "there is no head any more"
    await page.evaluate("head.setAttribute('head', 'generic')")
    await page.wait_for_function("said.hidden")
