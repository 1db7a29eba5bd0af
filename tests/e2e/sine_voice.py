"""A voice program: hums each phone it is told to, on its pitch, for exactly as long as it is asked to."""

import base64
import json
import math
import sys
from array import array

RATE = 16000


def main() -> None:
    print(json.dumps({"sample_rate": RATE}), flush=True)
    wished, at, phase = 0.0, 0, 0.0
    for line in sys.stdin:
        for phone in json.loads(line)["phones"]:
            wished += phone["duration"]
            end = round(wished * RATE)
            hz = phone["pitch"][0][1] if phone["pitch"] else 100.0
            loud = 0 if phone["phone"] == "_" else 9000
            sound = array("h")
            for _ in range(end - at):
                phase += 2 * math.pi * hz / RATE
                sound.append(int(loud * math.sin(phase)))
            row = {"phone": phone["phone"], "start": at / RATE, "duration": (end - at) / RATE}
            print(json.dumps(row))
            if sys.byteorder == "big":
                sound.byteswap()
            print(json.dumps({"pcm": base64.b64encode(sound.tobytes()).decode()}), flush=True)
            at = end


if __name__ == "__main__":
    main()
