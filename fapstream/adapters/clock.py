"""The machine's monotonic clock behind the Clock port."""

from __future__ import annotations

import asyncio
import time


class MonotonicClock:
    """Real time."""

    def now(self) -> float:
        """Seconds from an arbitrary origin."""
        return time.monotonic()

    async def sleep_until(self, when: float) -> None:
        """Return at `when` or later."""
        delay = when - self.now()
        if delay > 0:
            await asyncio.sleep(delay)
