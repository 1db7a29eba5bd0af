"""A page of another origin that embeds the head."""

from __future__ import annotations

import asyncio
from pathlib import Path

from playwright.async_api import Page

PAGE = """<!doctype html><meta charset="utf-8"><title>elsewhere</title><link rel="icon" href="data:,">
<body style="margin:0"><script type="module" src="http://{server}/fap-head.js"></script>
<fap-head id="head" capture {attributes}
src="ws://{socket}/ws" style="display:block;width:320px;height:320px"></fap-head>
"""


async def visit(
    page: Page, elsewhere: tuple[Path, str], server: str, socket: str, attributes: str = ""
) -> None:
    """Open a page of another origin with the head in it, which has these attributes as well."""
    folder, origin = elsewhere
    (folder / "page.html").write_text(
        PAGE.format(server=server, socket=socket, attributes=attributes), encoding="utf-8"
    )
    await page.goto(f"{origin}/page.html")


async def embed(page: Page, elsewhere: tuple[Path, str], server: str, socket: str) -> list[str]:
    """Visit, and wait for the connection; returns the list that collects the page's complaints."""
    complaints: list[str] = []
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.on("response", lambda r: complaints.append(f"{r.status} {r.url}") if r.status >= 400 else None)
    await visit(page, elsewhere, server, socket)
    await page.wait_for_function("document.querySelector('#head').server !== null")
    await asyncio.sleep(1.0)
    return complaints


async def until(page: Page, expression: str, timeout_s: float = 30.0) -> None:
    """Wait until it is true on a page of ours, whose policy forbids what Playwright's own waiting does: to
    evaluate text time and again in the page."""
    async with asyncio.timeout(timeout_s):
        while not await page.evaluate(expression):
            await asyncio.sleep(0.05)
