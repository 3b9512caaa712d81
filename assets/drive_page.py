#!/usr/bin/env python3
"""Opens pages of runs in headless Chromium and checks them: python3 assets/drive_page.py PAGE... [--pictures FOLDER]

A copy of each page, served on this machine, gets a script that turns, cuts and plays the bodies, changes every choice and says what it saw. A page
passes if the console stays empty, it opens within 1 s (--seconds) and its 3-D view within 3 s (drawn without a graphics card,
whose start alone takes .5 s to 1 s), the picture shows something and changes with the
step, warnings with a place have their marks in the view, and nothing is wider than the window, at 1280 and at 390 pixels. Needs Python's standard library and `chromium`
only; exits with 2 where there is no browser.
"""
import argparse
import http.server
import json
import pathlib
import queue
import shutil
import subprocess
import sys
import tempfile
import threading

CHECKS = """
<script>
(async function () {
  const found = {}, root = document.documentElement, wait = (ms) => new Promise((done) => setTimeout(done, ms));
  for (let i = 0; i < 400 && !root.dataset.ready; i++) await wait(25);
  found.opened = Number(root.dataset.opened || 1e6);
  found.ready = Number(root.dataset.ready || 1e6);
  found.broken = /cannot be shown/.test(document.body.innerText);
  found.charts = document.querySelectorAll('#charts .plot path').length;
  found.width = innerWidth;
  found.overflow = root.scrollWidth - root.clientWidth;
  found.stages = [];
  const runs = JSON.parse(document.getElementById('head').textContent);
  for (const canvas of document.querySelectorAll('.stage canvas')) {
    const gl = canvas.getContext('webgl2'), box = canvas.closest('[id^=view]');
    const picture = () => {
      const pixels = new Uint8Array(4 * canvas.width * canvas.height);
      gl.readPixels(0, 0, canvas.width, canvas.height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
      let other = 0, sum = 0;
      for (let i = 0; i < pixels.length; i += 4) {
        if (pixels[i] !== pixels[0] || pixels[i + 1] !== pixels[1] || pixels[i + 2] !== pixels[2]) other++;
        sum = (sum * 31 + pixels[i] + 7 * pixels[i + 1] + 13 * pixels[i + 2]) % 1000000007;
      }
      return { part: other / (pixels.length / 4), sum: sum };
    };
    const change = (e, v) => { e.value = v; e.dispatchEvent(new Event(e.type === 'range' ? 'input' : 'change')); };
    const stage = { steps: 0, pictures: [], marks: 0 };
    const frame = canvas.getBoundingClientRect();
    stage.places = runs[found.stages.length].marks.length;
    for (const label of box.querySelectorAll('.stage .mark')) {
      const at = label.getBoundingClientRect(), x = at.left + at.width / 2, y = at.top + at.height / 2;
      const inside = x > frame.left && x < frame.right && y > frame.top && y < frame.bottom;
      if (at.width > 0 && inside && label.title && box.parentNode.querySelector('li[id$="-' + label.textContent + '"]')) stage.marks++;
    }
    const slider = box.querySelector('.time input');
    stage.steps = Number(slider.max) + 1;
    change(slider, slider.max);
    await wait(150);
    stage.pictures.push(picture());
    change(slider, 0);
    await wait(150);
    stage.pictures.push(picture());
    canvas.dispatchEvent(new PointerEvent('pointerdown', { pointerId: 1, clientX: 100, clientY: 100, buttons: 1 }));
    canvas.dispatchEvent(new PointerEvent('pointermove', { pointerId: 1, clientX: 180, clientY: 130, buttons: 1 }));
    canvas.dispatchEvent(new PointerEvent('pointerup', { pointerId: 1 }));
    stage.pictures.push(picture());
    for (const select of box.querySelectorAll('select')) {
      const before = select.value;
      for (const option of Array.from(select.options)) { change(select, option.value); await wait(30); }
      change(select, before);
    }
    await wait(50);
    const cut = Array.from(box.querySelectorAll('select')).find((s) => s.parentNode.textContent.startsWith('Cut'));
    change(cut, 'x');
    stage.pictures.push(picture());
    change(cut, '');
    box.querySelector('.play').click();
    await wait(600);
    box.querySelector('.play').click();
    stage.error = gl.getError();
    stage.size = [canvas.width, canvas.height];
    found.stages.push(stage);
  }
  const plot = document.querySelector('#charts .plot');
  if (plot) {
    const at = plot.getBoundingClientRect();
    plot.dispatchEvent(new PointerEvent('pointermove', { clientX: at.left + at.width / 2, clientY: at.top + 50 }));
    found.value = plot.parentNode.querySelector('.value').textContent;
  }
  await fetch('/found', { method: 'POST', body: JSON.stringify(found) });
}());
</script>
"""

FLAGS = [
    "--headless", "--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking",
    "--disable-component-update", "--disable-sync", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
    "--ignore-gpu-blocklist", "--hide-scrollbars", "--enable-logging=stderr", "--log-level=0",
]


def command(browser, profile, size):
    return [browser, *FLAGS, f"--user-data-dir={profile}", f"--window-size={size[0]},{size[1]}"]


def visit(browser, text, size):
    """What the checks in a page found, and what the browser wrote to its console."""
    found = queue.Queue()

    class Handler(http.server.BaseHTTPRequestHandler):
        def do_GET(self):
            body = text.encode() if self.path == "/page.html" else b""
            self.send_response(200)
            self.send_header("Content-Type", "text/html; charset=utf-8" if body else "image/x-icon")
            self.end_headers()
            self.wfile.write(body)

        def do_POST(self):
            found.put(json.loads(self.rfile.read(int(self.headers["Content-Length"]))))
            self.send_response(204)
            self.end_headers()

        def log_message(self, *_):
            pass

    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    address = f"http://127.0.0.1:{server.server_port}/page.html"
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        errors = pathlib.Path(profile) / "stderr"
        with errors.open("w") as err:
            child = subprocess.Popen(
                [*command(browser, profile, size), "--remote-debugging-port=0", address],
                stdout=subprocess.DEVNULL,
                stderr=err,
            )
            try:
                result = found.get(timeout=90)
            except queue.Empty:
                result = None
            child.terminate()
            child.wait()
        written = errors.read_text(errors="replace").splitlines()
        console = [line for line in written if "CONSOLE" in line]
    server.shutdown()
    return result, console


def picture(browser, page, size, path, *more):
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        options = [f"--screenshot={path}", "--virtual-time-budget=6000", *more]
        # On a busy machine the browser may hang once.
        for attempt in range(2):
            try:
                subprocess.run([*command(browser, profile, size), *options, page.as_uri()], capture_output=True, timeout=60)
                return
            except subprocess.TimeoutExpired:
                print(f"{path}: no picture within 60 s" + (", once more" if attempt == 0 else ""), file=sys.stderr)


def check(browser, page, size, seconds):
    """What is wrong with a page at a size of the window."""
    text = page.read_text()
    # The checks may send what they found; nothing else changes.
    text = text.replace("default-src 'none'", "default-src 'none'; connect-src 'self'")
    found, console = visit(browser, text.replace("</body>", CHECKS + "</body>"), size)
    wrong = []
    if console:
        wrong.append("console: " + "; ".join(console))
    if found is None:
        return wrong + ["the page did not come to its end"], {}
    if found["opened"] > 1000 * seconds:
        wrong.append(f"opened after {found['opened']} ms")
    if found["ready"] > 3000 * seconds:
        wrong.append(f"3-D after {found['ready']} ms")
    if found["broken"]:
        wrong.append("something cannot be shown")
    if found["overflow"] > 0:
        wrong.append(f"{found['overflow']} pixels wider than a window of {found['width']}")
    if found["charts"] == 0 or not found.get("value"):
        wrong.append("no curves, or no value under the pointer")
    if not found["stages"]:
        wrong.append("no 3-D view")
    for stage in found["stages"]:
        pictures = stage["pictures"]
        if stage["marks"] != stage["places"]:
            wrong.append(f"{stage['places']} warnings with a place, {stage['marks']} marks in the view")
        if stage["error"] != 0:
            wrong.append(f"WebGL error {stage['error']}")
        if min(p["part"] for p in pictures[:3]) < 0.002:
            wrong.append(f"an empty picture: {[p['part'] for p in pictures]}")
        sums = [p["sum"] for p in pictures]
        if sums[1] == sums[2] or sums[2] == sums[3] or (stage["steps"] > 1 and sums[0] == sums[1]):
            wrong.append(f"the picture does not change with step, view or cut: {sums}")
    return wrong, found


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("pages", nargs="+", type=pathlib.Path)
    arguments.add_argument("--pictures", type=pathlib.Path, help="folder for pictures, light, dark and at the width of a phone")
    arguments.add_argument("--seconds", type=float, default=1.0)
    given = arguments.parse_args()
    browser = shutil.which("chromium") or shutil.which("chromium-browser")
    if browser is None:
        print("no chromium: pages are not opened", file=sys.stderr)
        return 2
    failed = False
    for page in given.pages:
        page = page.resolve()
        for size in [(1280, 900), (390, 844)]:
            wrong, found = check(browser, page, size, given.seconds)
            failed |= bool(wrong)
            print(f"{page.parent.name}/{page.name} at {size[0]}: opened after {found.get('opened')} ms, 3-D after {found.get('ready')} ms, {'; '.join(wrong) or 'as it should be'}")
        if given.pictures:
            given.pictures.mkdir(parents=True, exist_ok=True)
            for name, size, more in [
                ("light", (1280, 2600), []),
                ("dark", (1280, 2600), ["--blink-settings=preferredColorScheme=0"]),
                ("phone", (390, 3200), []),
            ]:
                path = given.pictures / f"{page.parent.name}_{name}.png"
                picture(browser, page, size, path, *more)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
