"""A headless Chromium driven through a pipe (DevTools protocol); no package beyond Python's own library.

The software rasteriser draws WebGL; every request that leaves the page and every complaint of its scripts is kept.
"""
import base64
import json
import os
import shutil
import subprocess
import tempfile
import time

TIMEOUT = 60


class Browser:
    def __init__(self, width=1280, height=900):
        self.home = tempfile.mkdtemp(prefix="browser-")
        read_commands, self.write = os.pipe()
        self.read, write_answers = os.pipe()

        def wire():
            # Chromium reads its commands from 3 and writes its answers to 4.
            commands, answers = os.dup(read_commands), os.dup(write_answers)
            os.dup2(commands, 3)
            os.dup2(answers, 4)

        self.process = subprocess.Popen(
            ["chromium", "--headless=new", "--remote-debugging-pipe", "--no-sandbox", "--use-angle=swiftshader",
             "--enable-unsafe-swiftshader", f"--user-data-dir={self.home}", "--no-first-run", "--disable-sync",
             "--disable-background-networking", "--disable-component-update", "--hide-scrollbars",
             "--disable-dev-shm-usage", f"--window-size={width},{height}", "about:blank"],
            preexec_fn=wire, close_fds=False, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
            start_new_session=True)
        os.close(read_commands)
        os.close(write_answers)
        self.buffer, self.number, self.session = b"", 0, None
        self.complaints, self.requests = [], []
        target = self.command("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.command("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.command(f"{domain}.enable")
        self.size(width, height)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        os.killpg(self.process.pid, 9)
        self.process.wait()
        shutil.rmtree(self.home, ignore_errors=True)

    def message(self, deadline):
        while b"\0" not in self.buffer:
            os.set_blocking(self.read, False)
            try:
                part = os.read(self.read, 1 << 20)
                if not part:
                    raise RuntimeError("Chromium ended by itself")
                self.buffer += part
            except BlockingIOError:
                if time.monotonic() > deadline:
                    raise TimeoutError("Chromium does not answer") from None
                time.sleep(0.005)
        text, _, self.buffer = self.buffer.partition(b"\0")
        return json.loads(text)

    def command(self, method, **parameters):
        self.number += 1
        words = {"id": self.number, "method": method, "params": parameters}
        if self.session:
            words["sessionId"] = self.session
        os.write(self.write, json.dumps(words).encode() + b"\0")
        deadline = time.monotonic() + TIMEOUT
        while True:
            message = self.message(deadline)
            if message.get("id") == self.number:
                if "error" in message:
                    raise RuntimeError(f"{method}: {message['error']['message']}")
                return message["result"]
            self.note(message)

    def note(self, message):
        method, words = message.get("method"), message.get("params", {})
        if method == "Runtime.exceptionThrown":
            details = words["exceptionDetails"]
            self.complaints.append(details.get("exception", {}).get("description", details["text"]))
        elif method == "Runtime.consoleAPICalled" and words["type"] in ("error", "warning", "assert"):
            self.complaints.append(" ".join(str(one.get("value", one)) for one in words["args"]))
        elif method == "Log.entryAdded" and words["entry"]["level"] in ("error", "warning"):
            self.complaints.append(words["entry"]["text"])
        elif method == "Network.requestWillBeSent":
            self.requests.append(words["request"]["url"])

    def evaluate(self, expression):
        result = self.command("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in result:
            raise RuntimeError(f"{expression}: {result['exceptionDetails']['text']}")
        return result["result"].get("value")

    def wait_until(self, expression):
        deadline = time.monotonic() + TIMEOUT
        while not self.evaluate(expression):
            if time.monotonic() > deadline:
                raise TimeoutError(f"never true: {expression}")
            time.sleep(0.02)

    def drawn(self):
        """What was asked for is on the screen: two frames of the browser have passed."""
        self.evaluate("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => done(1))))")

    def size(self, width, height):
        self.command("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)

    def open(self, path):
        self.command("Page.navigate", url=f"file://{os.path.abspath(path)}")
        self.wait_until("document.readyState === 'complete' && location.protocol === 'file:'")
        self.drawn()

    def box(self, selector):
        """x, y, width, height in the window, scrolled into it."""
        return self.evaluate(
            f"(() => {{ const e = document.querySelector({json.dumps(selector)}); e.scrollIntoView({{block: 'center'}}); "
            "const b = e.getBoundingClientRect(); return [b.x, b.y, b.width, b.height]; })()")

    def mouse(self, kind, x, y, **more):
        self.command("Input.dispatchMouseEvent", type=kind, x=x, y=y, **more)

    def click(self, selector, across=0.5):
        x, y, width, height = self.box(selector)
        x, y = x + across * width, y + height / 2
        self.mouse("mousePressed", x, y, button="left", clickCount=1)
        self.mouse("mouseReleased", x, y, button="left", clickCount=1)
        self.drawn()

    def drag(self, selector, dx, dy):
        x, y, width, height = self.box(selector)
        x, y = x + width / 2, y + height / 2
        self.mouse("mouseMoved", x, y)
        self.mouse("mousePressed", x, y, button="left", clickCount=1)
        for k in range(1, 9):
            self.mouse("mouseMoved", x + dx * k / 8, y + dy * k / 8, button="left", buttons=1)
        self.mouse("mouseReleased", x + dx, y + dy, button="left", clickCount=1)
        self.drawn()

    def wheel(self, selector, amount):
        x, y, width, height = self.box(selector)
        self.mouse("mouseWheel", x + width / 2, y + height / 2, deltaX=0, deltaY=amount)
        time.sleep(0.1)
        self.drawn()

    def screenshot(self, path, selector=None):
        clip = {}
        if selector:
            x, y, width, height = self.box(selector)
            scroll = self.evaluate("[scrollX, scrollY]")
            clip = {"clip": {"x": x + scroll[0], "y": y + scroll[1], "width": width, "height": height, "scale": 1}}
        data = self.command("Page.captureScreenshot", format="png", captureBeyondViewport=bool(selector), **clip)["data"]
        with open(path, "wb") as file:
            file.write(base64.b64decode(data))
        return path
