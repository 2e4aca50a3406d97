#!/usr/bin/env python3
"""Opens a report in headless Chromium and does what readers do: looks, zooms, hides a series,
changes to a phone and to the dark, prints. Speaks the browser's own protocol over a pipe.

  report_in_browser.py PROGRAM [CHROMIUM]   a short simulated run; 77: no Chromium here
  report_in_browser.py --page INDEX_HTML    a report that is there
"""
import base64
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time

SKIPPED = 77
SLOWEST_S = 1.0      # of the browser's main thread, until a page is there; machines may be busy
LARGEST_BYTES = 3e6  # of a page


class Browser:
    """Chromium behind a pipe: it reads commands from its descriptor 3 and answers on 4."""

    def __init__(self, program):
        to_read, self.to = os.pipe()
        self.back, back_write = os.pipe()
        self.profile = tempfile.TemporaryDirectory()

        def wire():
            read, write = os.dup(to_read), os.dup(back_write)
            os.dup2(read, 3)
            os.dup2(write, 4)

        self.process = subprocess.Popen(
            [program, '--headless', '--no-sandbox', '--disable-gpu', '--remote-debugging-pipe',
             '--force-device-scale-factor=1', '--user-data-dir=' + self.profile.name],
            preexec_fn=wire, pass_fds=(3, 4), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(to_read)
        os.close(back_write)
        self.number, self.rest, self.events, self.session = 0, b'', [], None
        target = self.call('Target.createTarget', url='about:blank')['targetId']
        self.session = self.call('Target.attachToTarget', targetId=target,
                                 flatten=True)['sessionId']
        for domain in ('Page', 'Runtime', 'Log', 'Network'):
            self.call(domain + '.enable')
        self.call('Performance.enable', timeDomain='threadTicks')

    def receive(self):
        while b'\0' not in self.rest:
            data = os.read(self.back, 1 << 20)
            if not data:
                raise RuntimeError('Chromium ended')
            self.rest += data
        message, self.rest = self.rest.split(b'\0', 1)
        return json.loads(message)

    def call(self, method, **params):
        self.number += 1
        message = {'id': self.number, 'method': method, 'params': params}
        if self.session:
            message['sessionId'] = self.session
        os.write(self.to, json.dumps(message).encode() + b'\0')
        while True:
            answer = self.receive()
            if answer.get('id') == self.number:
                if 'error' in answer:
                    raise RuntimeError(method + ': ' + answer['error']['message'])
                return answer['result']
            self.events.append(answer)

    def value(self, expression):
        result = self.call('Runtime.evaluate', expression=expression, returnByValue=True,
                           awaitPromise=True)
        if 'exceptionDetails' in result:
            raise RuntimeError(expression + ': ' + json.dumps(result['exceptionDetails']))
        return result['result'].get('value')

    def busy(self):
        """Time that the main thread has worked [s], others on the machine not counted."""
        metrics = self.call('Performance.getMetrics')['metrics']
        return next(m['value'] for m in metrics if m['name'] == 'TaskDuration')

    def open(self, page):
        """Returns how long the main thread worked for it [s]."""
        self.call('Page.navigate', url='file://' + page)
        while self.value('document.readyState') != 'complete':
            time.sleep(0.01)
        self.value('new Promise(r => requestAnimationFrame(() => requestAnimationFrame(r)))')
        return self.busy()  # counts from the navigation on

    def settle(self):
        self.value('new Promise(r => requestAnimationFrame(() => requestAnimationFrame(r)))')

    def mouse(self, kind, x, y, buttons=0, clicks=1):
        self.call('Input.dispatchMouseEvent', type=kind, x=x, y=y, buttons=buttons,
                  button='left' if kind != 'mouseMoved' else 'none', clickCount=clicks)

    def complaints(self):
        found = []
        for event in self.events:
            method, params = event.get('method'), event.get('params', {})
            if method == 'Runtime.exceptionThrown':
                found.append(json.dumps(params['exceptionDetails'])[:500])
            if method == 'Runtime.consoleAPICalled' and params['type'] in ('error', 'warning'):
                found.append(json.dumps(params['args'])[:500])
            if method == 'Log.entryAdded' and params['entry']['level'] == 'error':
                found.append(params['entry']['text'])
            if method == 'Network.requestWillBeSent':
                url = params['request']['url']
                if not url.startswith(('file:', 'data:', 'about:')):
                    found.append('asks the network for ' + url)
        return found

    def close(self):
        try:
            self.call('Browser.close')
        except (RuntimeError, OSError):
            pass
        self.process.wait(20)
        self.profile.cleanup()


class Checks:
    def __init__(self):
        self.passed = self.failed = 0

    def that(self, holds, what):
        self.passed += bool(holds)
        self.failed += not holds
        print(('ok    ' if holds else 'FAILED ') + what)


OVER_TIME = ('liveReport.figures.findIndex(f => f.panels.some(p => p.overTime) && '
             'f.element.id === "attitude")')


def plot_box(browser, figure):
    """The first panel of a figure, scrolled to, in pixels of the window."""
    browser.value(f'liveReport.figures[{figure}].canvas.scrollIntoView('
                  '{block: "center", behavior: "instant"})')
    while not browser.value(f'liveReport.figures[{figure}].seen'):
        browser.settle()
    browser.settle()
    return json.loads(browser.value(
        f'(() => {{ const f = liveReport.figures[{figure}], b = f.panels[0].box,'
        ' r = f.canvas.getBoundingClientRect();'
        ' return JSON.stringify([r.left + b.x, r.top + b.y, b.w, b.h]); })()'))


def check_zoom(browser, checks):
    figure = browser.value(OVER_TIME)
    x, y, w, h = plot_box(browser, figure)
    picture = f'liveReport.figures[{figure}].canvas.toDataURL()'
    whole = browser.value(picture)
    browser.mouse('mouseMoved', x + 0.5 * w, y + 0.5 * h)
    browser.settle()
    words = browser.value(f'liveReport.figures[{figure}].readout.textContent')
    checks.that('UTC' in words and 'GPS' in words and 'estimate' in words,
                'the cursor tells the clock and values: ' + words[:150])
    browser.mouse('mousePressed', x + 0.4 * w, y + 0.5 * h, 1)
    browser.mouse('mouseMoved', x + 0.5 * w, y + 0.5 * h, 1)
    browser.mouse('mouseMoved', x + 0.6 * w, y + 0.5 * h, 1)
    browser.mouse('mouseReleased', x + 0.6 * w, y + 0.5 * h)
    browser.settle()
    first = f'liveReport.figures[{figure}].panels[0]'
    share = browser.value(f'({first}.x.max - {first}.x.min) / '
                          f'({first}.spec.x.range[1] - {first}.spec.x.range[0])')
    checks.that(abs(share - 0.2) < 0.01, f'dragging over a fifth shows a fifth ({share:.3f})')
    others = browser.value(
        'liveReport.figures.every(f => (f.arrange(), f.panels.every(p => !p.overTime || '
        'p.x.max === liveReport.shared.range[1])))')
    checks.that(others, 'all figures over time show the same time')
    checks.that(browser.value(picture) != whole, 'the zoomed figure looks different')
    browser.mouse('mousePressed', x + 0.5 * w, y + 0.5 * h, 1, 2)
    browser.mouse('mouseReleased', x + 0.5 * w, y + 0.5 * h, 0, 2)
    browser.settle()
    checks.that(browser.value('liveReport.shared.range === null'), 'a double click shows all again')


def check_keys_and_series(browser, checks):
    figure = browser.value(OVER_TIME)
    browser.value(f'liveReport.figures[{figure}].canvas.focus()')
    for key in ('ArrowRight', '+'):
        browser.call('Input.dispatchKeyEvent', type='keyDown', key=key)
    browser.settle()
    checks.that(browser.value('liveReport.shared.cursor !== null && liveReport.shared.range !== null'),
                'keys move the cursor and zoom')
    browser.call('Input.dispatchKeyEvent', type='keyDown', key='0')
    before = browser.value(f'liveReport.figures[{figure}].canvas.toDataURL()')
    browser.value(f'[...liveReport.figures[{figure}].buttons.querySelectorAll("button")].pop().click()')
    browser.settle()
    checks.that(browser.value(f'liveReport.figures[{figure}].canvas.toDataURL()') != before,
                'a click on a name takes its series out')
    browser.value(f'[...liveReport.figures[{figure}].buttons.querySelectorAll("button")].pop().click()')


def check_screens(browser, checks, shots):
    def shot(name):
        if shots:
            data = browser.call('Page.captureScreenshot', format='png')['data']
            with open(os.path.join(shots, name + '.png'), 'wb') as file:
                file.write(base64.b64decode(data))

    def size(width, height, phone):
        browser.call('Emulation.setDeviceMetricsOverride', width=width, height=height,
                     deviceScaleFactor=1, mobile=phone)
        browser.settle()

    browser.value('scrollTo(0, 0)')
    size(1280, 1000, False)
    shot('light')
    browser.call('Emulation.setEmulatedMedia', media='screen',
                 features=[{'name': 'prefers-color-scheme', 'value': 'dark'}])
    paper = browser.value('getComputedStyle(document.querySelector("main")).backgroundColor')
    checks.that(sum(int(v) for v in paper[4:-1].split(',')) < 200, 'dark where the reader is: ' + paper)
    shot('dark')
    browser.call('Emulation.setEmulatedMedia', media='', features=[])
    size(390, 844, True)
    wide = browser.value('document.documentElement.scrollWidth')
    checks.that(wide <= 391, f'nothing is wider than a phone ({wide} of 390)')
    shot('phone')
    browser.call('Emulation.clearDeviceMetricsOverride')


def check_print(browser, checks, shots):
    browser.call('Emulation.setEmulatedMedia', media='print')
    millimetre = 96 / 25.4
    browser.call('Emulation.setDeviceMetricsOverride', width=round(180 * millimetre),
                 height=round(265 * millimetre), deviceScaleFactor=1, mobile=False)
    browser.settle()
    sizes = json.loads(browser.value(
        'JSON.stringify([...document.querySelectorAll("figure")].map(f => [f.id,'
        ' f.getBoundingClientRect().height, f.querySelector("img").getBoundingClientRect().width,'
        ' getComputedStyle(f).breakInside, f.querySelector("img").naturalWidth]))'))
    cut = [s[0] for s in sizes if s[1] > 265 * millimetre or s[2] > 180.5 * millimetre or
           s[3] != 'avoid' or s[2] < 50 or s[4] == 0]
    checks.that(sizes and not cut, f'each of {len(sizes)} figures fits a page in print ' + ' '.join(cut))
    pdf = base64.b64decode(browser.call('Page.printToPDF', preferCSSPageSize=True)['data'])
    checks.that(pdf[:4] == b'%PDF', f'it prints ({len(pdf) / 1e6:.1f} MB)')
    opened = browser.value('[...document.querySelectorAll("details")].every(d => d.open)')
    checks.that(opened, 'what is folded is open on paper')
    if shots:
        with open(os.path.join(shots, 'print.pdf'), 'wb') as file:
            file.write(pdf)
    browser.call('Emulation.clearDeviceMetricsOverride')
    browser.call('Emulation.setEmulatedMedia', media='')


def check(page, chromium, shots=None):
    checks = Checks()
    browser = Browser(chromium)
    try:
        browser.open(page)  # the browser itself is warm afterwards
        took = browser.open(page)
        checks.that(took < SLOWEST_S, f'the page is there after {took:.2f} s of work')
        size = os.path.getsize(page)
        checks.that(size < LARGEST_BYTES, f'it has {size / 1e6:.2f} MB')
        live = browser.value('liveReport.figures.length')
        still = browser.value('document.querySelectorAll("figure").length')
        checks.that(live > 0, f'{live} of {still} figures are live')
        short = browser.value('[...document.images].filter(i => i.alt.length < 15).length')
        checks.that(short == 0, 'every figure says in words what is seen')
        check_zoom(browser, checks)
        check_keys_and_series(browser, checks)
        check_screens(browser, checks, shots)
        check_print(browser, checks, shots)
        complaints = browser.complaints()
        checks.that(not complaints, 'no error on the console, nothing from a network ' +
                    ' '.join(complaints))
    finally:
        browser.close()
    print(f'{checks.passed} passed, {checks.failed} failed')
    return 1 if checks.failed else 0


def simulated_page(program, folder):
    log, out = os.path.join(folder, 'trip.rawlog'), os.path.join(folder, 'trip')
    for command in ([program, 'simulate', '--imu', 'ADIS16465', '--duration', '200', '--seed', '7',
                     '--out', log], [program, 'run', log, '--out', out]):
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return os.path.join(out, 'report', 'index.html')


def main(arguments):
    chromium = shutil.which('chromium') or shutil.which('google-chrome')
    if not chromium:
        print('skipped: no chromium here (apps/setup.sh --tests installs it)')
        return SKIPPED
    if arguments[0] == '--page':
        return check(os.path.abspath(arguments[1]), chromium, *arguments[2:])
    with tempfile.TemporaryDirectory() as folder:
        return check(simulated_page(arguments[0], folder), chromium)


sys.exit(main(sys.argv[1:]))
