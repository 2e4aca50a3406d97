// Makes the figures of a report live: zoom, values under the cursor, series on and off, one time
// cursor and one time range over all figures. Without it the images stand where they are.
(() => {
'use strict';
const source = document.getElementById('live-data');
if (!source) return;
const page = JSON.parse(source.textContent);
const dark = matchMedia('(prefers-color-scheme: dark)');
const figures = [];
const shared = {range: null, cursor: null};  // of the axes over time [s]

// ---- numbers

const columns = [];
function column(i) {
  if (i === undefined) return null;
  if (columns[i]) return columns[i];
  const [text, low, high] = page.columns[i];
  const raw = atob(text);
  const values = new Float64Array(raw.length / 3);
  for (let k = 0; k < values.length; ++k) {
    const code =
        raw.charCodeAt(3 * k) << 16 | raw.charCodeAt(3 * k + 1) << 8 | raw.charCodeAt(3 * k + 2);
    values[k] = code === 0xffffff ? NaN : low + (high - low) * code / 0xfffffe;
  }
  return columns[i] = values;
}

const minus = text => text.replace('-', '\u2212');
function number(value, step) {
  if (!Number.isFinite(value)) return '\u2013';
  if (value !== 0 && (Math.abs(value) >= 1e7 || Math.abs(value) < 1e-4)) {
    return minus(value.toExponential(3));
  }
  const decimals = step ? Math.max(0, Math.ceil(-Math.log10(step) - 1e-9))
                        : Math.max(0, 4 - Math.floor(Math.log10(Math.abs(value) || 1)));
  return minus(value.toFixed(Math.min(decimals, 9)));
}

function clock(t) {
  const parts = [number(t, 0.001) + ' s'];
  if (page.start_ms !== undefined) {
    parts.push(new Date(page.start_ms + 1000 * t).toISOString().slice(11, 23) + ' UTC');
    parts.push('GPS ' + (page.gps_second + t).toFixed(3) + ' s');
  }
  return parts.join(' \u00b7 ');
}

function colour(ink) {
  if (ink === 'black') return css('--ink');
  return page.inks[ink];
}
const css = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

// ---- axes

function roundStep(least) {
  const power = 10 ** Math.floor(Math.log10(least));
  return [1, 2, 5, 10].map(m => m * power).find(s => s >= least * 0.999999);
}

function linearTicks(min, max, count, factor, steps) {
  const least = (max - min) * factor / Math.max(1, count);
  const step = (steps || []).find(s => s >= least * 0.999999) || roundStep(least);
  const ticks = [];
  for (let k = Math.ceil(min * factor / step - 1e-9); k * step <= max * factor + 1e-9 * step; ++k) {
    ticks.push([k * step / factor, number(k * step, step)]);
  }
  return ticks;
}

function logTicks(min, max, count) {
  const decades = Math.log10(max / min);
  if (decades < 0.7) return linearTicks(min, max, count, 1);
  const every = Math.ceil(decades / Math.max(1, count));
  const ticks = [];
  for (let e = Math.floor(Math.log10(min)); e <= Math.ceil(Math.log10(max)); ++e) {
    for (const m of every > 1 ? [1] : [1, 2, 5]) {
      const at = m * 10 ** e;
      if (at < min || at > max || (every > 1 && e % every)) continue;
      const named = m === 1 || decades < 1.5;
      ticks.push([at, !named ? '' : Math.abs(e) > 4 ? m + 'e' + minus('' + e) : '' + +at.toPrecision(1)]);
    }
  }
  return ticks;
}

class Scale {
  constructor(axis, range, from, to) {
    Object.assign(this, {axis, min: range[0], max: range[1], from, to});
    this.log = axis.kind === 'log';
  }
  pixel(v) {
    const share = this.log ? Math.log(v / this.min) / Math.log(this.max / this.min)
                           : (v - this.min) / (this.max - this.min);
    return this.from + share * (this.to - this.from);
  }
  value(p) {
    const share = (p - this.from) / (this.to - this.from);
    return this.log ? this.min * (this.max / this.min) ** share
                    : this.min + share * (this.max - this.min);
  }
  time() {  // the unit of an axis over time
    const most = Math.max(Math.abs(this.min), Math.abs(this.max));
    return most <= 300 || this.max - this.min < 120 ? ['s', 1]
        : most <= 18000                             ? ['min', 1 / 60]
                                                    : ['h', 1 / 3600];
  }
  ticks(count) {
    const axis = this.axis;
    if (axis.kind === 'category') return (axis.names || []).map((name, i) => [i, name]);
    if (this.log) return logTicks(this.min, this.max, count);
    if (axis.kind === 'duration') return linearTicks(this.min, this.max, count, this.time()[1]);
    if (axis.kind === 'bearing') {
      return linearTicks(this.min, this.max, count, 1, [1, 2, 5, 10, 15, 30, 45, 90]);
    }
    return linearTicks(this.min, this.max, count, axis.factor);
  }
  title() {
    const unit = this.axis.kind === 'duration' ? this.time()[0] : this.axis.unit;
    if (!unit || !this.axis.label) return this.axis.label || unit;
    return this.axis.label + ' (' + unit + ')';
  }
}

// ---- drawing

const DASHES = {none: [], dashes: [7, 4], long_dashes: [14, 4], dots: [1.6, 3], dash_dot: [9, 3, 1.6, 3]};

function marker(g, shape, x, y, r) {
  g.beginPath();
  if (shape === 'cross' || shape === 'plus' || shape === 'tick') {
    const k = shape === 'cross' ? 0.85 * r : r;
    if (shape === 'cross') g.moveTo(x - k, y - k), g.lineTo(x + k, y + k), g.moveTo(x - k, y + k), g.lineTo(x + k, y - k);
    if (shape === 'plus') g.moveTo(x - k, y), g.lineTo(x + k, y);
    if (shape !== 'cross') g.moveTo(x, y - k), g.lineTo(x, y + k);
    g.stroke();
  } else if (shape === 'square') {
    g.fillRect(x - r, y - r, 2 * r, 2 * r);
  } else if (shape === 'diamond' || shape === 'triangle') {
    g.moveTo(x, y - r), g.lineTo(x + r, shape === 'diamond' ? y : y + 0.8 * r);
    if (shape === 'diamond') g.lineTo(x, y + r);
    g.lineTo(x - r, shape === 'diamond' ? y : y + 0.8 * r), g.fill();
  } else {
    g.arc(x, y, r, 0, 7);
    shape === 'ring' ? g.stroke() : g.fill();
  }
}

function arrowhead(g, x, y, up) {
  const k = up ? 6 : -6;
  g.beginPath(), g.moveTo(x, y), g.lineTo(x + 3, y + k), g.lineTo(x - 3, y + k), g.fill();
}

class Panel {
  constructor(spec, figure) {
    Object.assign(this, {spec, figure, zoomX: null, zoomY: null});
    this.overTime = spec.x.kind === 'duration';
    this.series = spec.series.map(s => ({
      ...s, hidden: false, xs: column(s.x), ys: column(s.y), low: column(s.lower),
      high: column(s.upper), kinds: column(s.category), times: column(s.time)
    }));
  }

  place(box) {
    this.box = box;
    let rx = this.overTime && shared.range ? shared.range : this.zoomX || this.figure.wholeX(this);
    let ry = this.zoomY || this.spec.y.range;
    if (this.spec.equal) [rx, ry] = this.equalized(rx, ry);
    this.x = new Scale(this.spec.x, rx, box.x, box.x + box.w);
    this.y = new Scale(this.spec.y, ry, box.y + box.h, box.y);
  }

  equalized(rx, ry) {
    const unit = Math.max((rx[1] - rx[0]) / this.box.w, (ry[1] - ry[0]) / this.box.h);
    const widen = (r, width) => [(r[0] + r[1] - width) / 2, (r[0] + r[1] + width) / 2];
    return [widen(rx, unit * this.box.w), widen(ry, unit * this.box.h)];
  }

  draw(g) {
    const b = this.box;
    this.grid(g);
    g.save();
    g.beginPath(), g.rect(b.x, b.y - 4, b.w, b.h + 8), g.clip();
    for (const [begin, end, , ink] of this.spec.shades) {
      g.globalAlpha = 0.16, g.fillStyle = colour(ink);
      const left = this.x.pixel(begin);
      g.fillRect(left, b.y, Math.max(1.5, this.x.pixel(end) - left), b.h);
    }
    for (const line of this.spec.lines) this.rule(g, line);
    const bars = this.series.filter(s => s.mark === 'bars' && !s.hidden);
    for (const s of this.series) {
      if (s.hidden) continue;
      g.strokeStyle = g.fillStyle = colour(s.ink), g.globalAlpha = s.opacity;
      g.lineWidth = Math.max(1, 1.1 * s.size), g.setLineDash([]);
      if (s.mark === 'band') this.band(g, s);
      else if (s.mark === 'points') this.points(g, s);
      else if (s.mark === 'bars') this.bars(g, s, bars.indexOf(s), bars.length);
      else this.line(g, s);
    }
    g.globalAlpha = 1;
    for (const [x, y, text, side, ink] of this.spec.annotations) this.annotate(g, x, y, text, side, ink);
    g.restore();
    this.heads(g);
    this.cursor(g);
  }

  grid(g) {
    const b = this.box, ticks = [this.x.ticks(b.w / 90), this.y.ticks(b.h / 45)];
    g.font = '11.5px system-ui, sans-serif', g.lineWidth = 1, g.setLineDash([]);
    g.strokeStyle = css('--line'), g.fillStyle = css('--soft'), g.globalAlpha = 1;
    for (const [at, label] of ticks[0]) {
      const x = Math.round(this.x.pixel(at)) + 0.5;
      if (x < b.x - 1 || x > b.x + b.w + 1) continue;
      g.beginPath(), g.moveTo(x, b.y), g.lineTo(x, b.y + b.h + 4), g.stroke();
      g.textAlign = 'center', g.textBaseline = 'top';
      if (b.labels) g.fillText(label, x, b.y + b.h + 7);
    }
    for (const [at, label] of ticks[1]) {
      const y = Math.round(this.y.pixel(at)) + 0.5;
      if (y < b.y - 1 || y > b.y + b.h + 1) continue;
      g.beginPath(), g.moveTo(b.x - 4, y), g.lineTo(b.x + b.w, y), g.stroke();
      g.textAlign = 'right', g.textBaseline = 'middle';
      g.fillText(label, b.x - 7, y);
    }
    g.strokeStyle = css('--soft');
    g.beginPath(), g.moveTo(b.x + 0.5, b.y), g.lineTo(b.x + 0.5, b.y + b.h + 0.5);
    g.lineTo(b.x + b.w, b.y + b.h + 0.5), g.stroke();
    g.fillStyle = css('--ink'), g.font = '12.5px system-ui, sans-serif', g.textAlign = 'center';
    if (b.labels) g.fillText(this.x.title(), b.x + b.w / 2, b.y + b.h + 32);
    g.save(), g.translate(b.left + 8, b.y + b.h / 2), g.rotate(-Math.PI / 2);
    g.fillText(this.y.title(), 0, 0), g.restore();
  }

  rule(g, [level, at, label, ink, dashed]) {
    const b = this.box, p = level ? this.y.pixel(at) : this.x.pixel(at);
    g.globalAlpha = 1, g.strokeStyle = g.fillStyle = colour(ink), g.lineWidth = 1.2;
    g.setLineDash(dashed ? DASHES.dashes : []), g.beginPath();
    level ? (g.moveTo(b.x, p), g.lineTo(b.x + b.w, p)) : (g.moveTo(p, b.y), g.lineTo(p, b.y + b.h));
    g.stroke(), g.textBaseline = 'bottom', g.textAlign = level ? 'right' : 'left';
    g.font = '11.5px system-ui, sans-serif';
    g.fillText(label, level ? b.x + b.w - 6 : p + 4, level ? p - 2 : b.y + 14);
  }

  // The first and one past the last index that can be seen.
  seen(s) {
    if (!s.sorted) s.sorted = s.xs.every((v, i) => !i || v >= s.xs[i - 1]) ? 'yes' : 'no';
    if (s.sorted === 'no') return [0, s.xs.length];
    return [Math.max(0, lowerBound(s.xs, this.x.min) - 2), Math.min(s.xs.length, lowerBound(s.xs, this.x.max) + 2)];
  }

  line(g, s) {
    const [from, to] = this.seen(s), steps = s.mark === 'steps';
    g.setLineDash(DASHES[s.dash] || []), g.lineJoin = 'round', g.beginPath();
    let pen = false, last = 0;
    for (let i = from; i < to; ++i) {
      const x = this.x.pixel(s.xs[i]), y = this.y.pixel(s.ys[i]);
      if (!Number.isFinite(x + y)) { pen = false; continue; }
      if (pen && steps) g.lineTo(x, last);
      pen ? g.lineTo(x, y) : g.moveTo(x, y);
      pen = true, last = y;
    }
    g.stroke(), g.setLineDash([]);
  }

  band(g, s) {
    const [from, to] = this.seen(s);
    let run = [];
    const fill = () => {
      if (run.length > 1) {
        g.beginPath();
        for (const i of run) g.lineTo(this.x.pixel(s.xs[i]), this.y.pixel(s.high[i]));
        for (const i of run.reverse()) g.lineTo(this.x.pixel(s.xs[i]), this.y.pixel(s.low[i]));
        g.fill();
      }
      run = [];
    };
    for (let i = from; i < to; ++i) Number.isFinite(s.low[i] + s.high[i]) ? run.push(i) : fill();
    fill();
  }

  points(g, s) {
    const [from, to] = this.seen(s), b = this.box, r = Math.max(1.4, 0.6 * s.size);
    g.lineWidth = s.shape === 'tick' ? 1 : Math.max(1.2, 0.3 * s.size);
    for (let i = from; i < to; ++i) {
      const x = this.x.pixel(s.xs[i]), y = this.y.pixel(s.ys[i]);
      if (!Number.isFinite(x + y) || x < b.x - 2 || x > b.x + b.w + 2) continue;
      if (s.kinds) {
        const kind = s.categories[s.kinds[i]];
        if (!kind || this.figure.off.has(kind[0])) continue;
        g.strokeStyle = g.fillStyle = colour(kind[1]);
      }
      if (s.low) {
        g.beginPath(), g.moveTo(x, this.y.pixel(s.low[i])), g.lineTo(x, this.y.pixel(s.high[i])), g.stroke();
      }
      if (y >= b.y - 1 && y <= b.y + b.h + 1) marker(g, s.shape, x, y, r);
    }
  }

  bars(g, s, place, count) {
    const width = 0.78 / count, base = this.y.log ? this.box.y + this.box.h : this.y.pixel(0);
    for (let i = 0; i < s.xs.length; ++i) {
      const centre = s.xs[i] + (place + 0.5) * width - 0.39, y = this.y.pixel(s.ys[i]);
      const left = this.x.pixel(centre - 0.46 * width), right = this.x.pixel(centre + 0.46 * width);
      g.fillRect(left, Math.min(y, base), right - left, Math.abs(base - y));
      if (!s.low) continue;
      const x = (left + right) / 2, ink = g.strokeStyle;
      g.strokeStyle = css('--ink'), g.beginPath();
      g.moveTo(x, this.y.pixel(s.low[i])), g.lineTo(x, this.y.pixel(s.high[i])), g.stroke();
      g.strokeStyle = ink;
    }
  }

  // Arrowheads for what lies beyond the axis.
  heads(g) {
    if (this.spec.equal) return;
    const b = this.box;
    for (const s of this.series) {
      if (s.hidden || !s.ys || s.mark === 'bars' || s.mark === 'band') continue;
      const [from, to] = this.seen(s), last = [-99, -99];
      g.fillStyle = colour(s.ink), g.globalAlpha = 1;
      for (let i = from; i < to; ++i) {
        const x = this.x.pixel(s.xs[i]), y = this.y.pixel(s.ys[i]);
        if (!(x >= b.x && x <= b.x + b.w)) continue;
        const side = y < b.y - 1 ? 0 : y > b.y + b.h + 1 ? 1 : 2;
        if (side === 2 || Math.abs(x - last[side]) < 6) continue;
        last[side] = x, arrowhead(g, x, side ? b.y + b.h : b.y, !side);
      }
    }
  }

  annotate(g, x, y, text, side, ink) {
    const px = this.x.pixel(x), py = this.y.pixel(y), b = this.box;
    g.font = '12px system-ui, sans-serif', g.fillStyle = colour(ink), g.textBaseline = 'middle';
    const left = side === 'left' || px + 80 > b.x + b.w;
    g.textAlign = side === 'centre' ? 'center' : left ? 'right' : 'left';
    g.fillText(text, side === 'centre' ? px : px + (left ? -8 : 8), py);
  }

  // ---- the cursor

  at() { return this.overTime ? shared.cursor : this.own; }

  cursor(g) {
    const at = this.at(), b = this.box;
    g.globalAlpha = 1, g.setLineDash([]), g.strokeStyle = css('--accent'), g.lineWidth = 1;
    if (at !== null && at !== undefined && !this.spec.equal) {
      const x = this.x.pixel(at);
      if (x < b.x || x > b.x + b.w) return;
      g.beginPath(), g.moveTo(x, b.y), g.lineTo(x, b.y + b.h), g.stroke();
    }
    if (!this.spec.equal || shared.cursor === null) return;
    for (const s of this.series) {  // where it was at that time
      if (!s.times || s.hidden) continue;
      const i = nearest(s.times, shared.cursor);
      if (i < 0) continue;
      g.lineWidth = 2.5, g.beginPath();
      g.arc(this.x.pixel(s.xs[i]), this.y.pixel(s.ys[i]), 7, 0, 7), g.stroke();
    }
  }

  words() {
    const at = this.at(), name = this.spec.title || this.spec.y.label, unit = this.spec.y.unit;
    const factor = this.spec.y.factor, words = [];
    for (const s of this.series) {
      if (s.hidden || !s.label) continue;
      const times = this.spec.equal ? s.times : s.xs;
      const i = times ? nearest(times, this.spec.equal ? shared.cursor : at) : -1;
      if (i < 0) continue;
      if (this.spec.equal) words.push(`${s.label} ${number(s.ys[i] * factor)} ${unit} north, ${number(s.xs[i] * factor)} ${unit} east`);
      else if (s.mark === 'band') words.push(`${s.label} ${number(s.low[i] * factor)} \u2026 ${number(s.high[i] * factor)}`);
      else if (this.spec.y.kind === 'category') words.push(this.spec.y.names[Math.round(s.ys[i])] || '');
      else words.push(`${s.label} ${number(s.ys[i] * factor)} ${unit}`);
    }
    return words.length ? [name, words.join(', ')] : null;
  }
}

function lowerBound(values, wanted) {
  let low = 0, high = values.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    values[middle] < wanted ? low = middle + 1 : high = middle;
  }
  return low;
}

// The index of the nearest of increasing numbers, -1 if it is far away.
function nearest(values, wanted) {
  if (wanted === null || wanted === undefined || !values.length) return -1;
  let i = Math.min(lowerBound(values, wanted), values.length - 1);
  if (i > 0 && Math.abs(values[i - 1] - wanted) < Math.abs(values[i] - wanted)) --i;
  const span = Math.abs(values[values.length - 1] - values[0]);
  return Math.abs(values[i] - wanted) <= 0.02 * span + 1e-9 ? i : -1;
}

// ---- a figure

class Figure {
  constructor(element, spec) {
    Object.assign(this, {element, spec, off: new Set(), samples: [], seen: false, drag: null});
    this.build();
    this.panels = spec.panels.map(p => new Panel(p, this));
    this.legend();
    this.canvas.style.height = this.arrange()[1] + 'px';  // the page does not jump later
    new IntersectionObserver(entries => {
      this.seen = entries[0].isIntersecting;
      if (this.seen) this.paint();
    }, {rootMargin: '200px'}).observe(this.canvas);
  }

  build() {
    const make = (tag, name, parent, text) => {
      const e = document.createElement(tag);
      e.className = name;
      if (text) e.textContent = text;
      return parent.appendChild(e);
    };
    const live = make('div', 'live', this.element);
    this.element.insertBefore(live, this.element.firstChild);
    const head = make('div', 'live-head', live);
    make('b', '', head, this.spec.title);
    const tools = make('span', 'tools', head);
    for (const [sign, title, act] of [['+', 'zoom in', () => this.scale(0.5)],
                                      ['\u2212', 'zoom out', () => this.scale(2)],
                                      ['\u21ba', 'show all', () => this.reset()]]) {
      const button = make('button', '', tools, sign);
      button.type = 'button', button.title = title, button.onclick = act;
      button.setAttribute('aria-label', title + ': ' + this.spec.title);
    }
    this.buttons = make('div', 'series', live);
    this.canvas = make('canvas', '', live);
    this.canvas.tabIndex = 0;
    this.canvas.setAttribute('role', 'img');
    this.canvas.setAttribute('aria-label', this.element.querySelector('img').alt +
        ' Arrow keys move the cursor, plus and minus zoom, 0 shows all.');
    this.readout = make('p', 'readout', live);
    this.readout.setAttribute('aria-live', 'polite');
    this.listen();
    this.element.classList.add('is-live');
  }

  legend() {
    const labels = new Map();
    for (const panel of this.panels) {
      for (const s of panel.series) {
        if (!s.legend) continue;
        if (s.kinds) {
          const used = new Set(s.kinds);
          s.categories.forEach(([name, ink], i) => used.has(i) && labels.set(name, {...s, ink}));
        } else if (s.label && s.xs.length) labels.set(s.label, s);
      }
    }
    const shades = new Map();
    for (const p of this.panels) for (const [, , name, ink] of p.spec.shades) if (name) shades.set(name, ink);
    for (const [label, s] of labels) {
      const button = document.createElement('button');
      button.type = 'button', button.textContent = label;
      button.setAttribute('aria-pressed', 'true');
      button.prepend(this.sample(s));
      button.onclick = () => this.toggle(label, button);
      this.buttons.append(button);
    }
    for (const [name, ink] of shades) {
      const word = document.createElement('span');
      word.textContent = name;
      word.prepend(this.sample({mark: 'band', ink, opacity: 0.25}));
      this.buttons.append(word);
    }
  }

  sample(s) {
    const c = document.createElement('canvas');
    const draw = () => this.drawSample(c, s);
    this.samples.push(draw), draw();
    return c;
  }

  drawSample(c, s) {
    const ratio = 2;
    c.width = 26 * ratio, c.height = 12 * ratio;  // clears it, too
    const g = c.getContext('2d');
    g.scale(ratio, ratio), g.strokeStyle = g.fillStyle = colour(s.ink);
    g.lineWidth = Math.max(1.6, s.size || 1), g.globalAlpha = Math.max(0.35, s.opacity);
    if (s.mark === 'points') marker(g, s.shape, 13, 6, 4);
    else if (s.mark === 'band' || s.mark === 'bars') g.fillRect(2, 1, 22, 10);
    else g.setLineDash(DASHES[s.dash] || []), g.beginPath(), g.moveTo(1, 6), g.lineTo(25, 6), g.stroke();
  }

  toggle(label, button) {
    const on = this.off.has(label);
    on ? this.off.delete(label) : this.off.add(label);
    button.setAttribute('aria-pressed', on);
    for (const p of this.panels) for (const s of p.series) if (s.label === label) s.hidden = !on;
    this.paint();
  }

  wholeX(panel) {
    if (!this.spec.share_x) return panel.spec.x.range;
    const step = this.spec.columns, at = this.panels.indexOf(panel) % step;
    const all = this.panels.filter((p, i) => i % step === at).map(p => p.spec.x.range);
    return [Math.min(...all.map(r => r[0])), Math.max(...all.map(r => r[1]))];
  }

  arrange() {
    const width = this.canvas.clientWidth, narrow = width < 560, n = this.panels.length;
    const cols = narrow ? 1 : Math.min(this.spec.columns, n), rows = Math.ceil(n / cols);
    const height = narrow && (this.spec.columns > 1 || n > 1)
        ? rows * 210 + 50 : Math.max(210, width * this.spec.height / this.spec.width);
    const names = Math.max(0, ...this.panels.filter(p => p.spec.y.kind === 'category')
        .flatMap(p => p.spec.y.names || []).map(name => name.length));
    const left = Math.min(0.35 * width, Math.max(62, 24 + 6.4 * names)), gap = 14;
    const shares = [], heads = [], feet = [];
    for (let r = 0; r < rows; ++r) {
      const row = this.panels.slice(r * cols, (r + 1) * cols);
      shares.push(Math.max(...row.map(p => p.spec.share)));
      heads.push(row.some(p => p.spec.title || p.spec.note) ? 24 : 8);
      feet.push(!this.spec.share_x || r === rows - 1 ? 44 : 12);
    }
    const sum = a => a.reduce((x, y) => x + y, 0);
    const room = height - sum(heads) - sum(feet), column = (width - (cols - 1) * gap) / cols;
    let y = 0;
    this.panels.forEach((panel, i) => {
      const r = Math.floor(i / cols), c = i % cols;
      if (c === 0 && r > 0) y += room * shares[r - 1] / sum(shares) + heads[r - 1] + feet[r - 1];
      const x = c * (column + gap);
      panel.place({left: x, x: x + left, y: y + heads[r], w: column - left - 8,
                   h: room * shares[r] / sum(shares), labels: feet[r] > 20 || i + cols >= n});
    });
    return [width, height];
  }

  paint() {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => { this.waiting = false, this.render(); });
  }

  render() {
    const [width, height] = this.arrange(), ratio = devicePixelRatio || 1, canvas = this.canvas;
    canvas.style.height = height + 'px';
    canvas.width = Math.round(width * ratio), canvas.height = Math.round(height * ratio);
    const g = canvas.getContext('2d');
    g.scale(ratio, ratio);
    for (const panel of this.panels) {
      panel.draw(g);
      const b = panel.box;
      g.textBaseline = 'bottom', g.fillStyle = css('--ink'), g.font = '600 12.5px system-ui, sans-serif';
      g.textAlign = 'left', g.fillText(panel.spec.title, b.x, b.y - 5);
      g.fillStyle = css('--soft'), g.font = '11.5px system-ui, sans-serif', g.textAlign = 'right';
      g.fillText(panel.spec.note, b.x + b.w, b.y - 5, 0.8 * b.w);
    }
    if (this.drag && this.drag.moved) {
      const {x, y, to} = this.drag;
      g.globalAlpha = 0.15, g.fillStyle = css('--accent');
      g.fillRect(x, y, to[0] - x, to[1] - y), g.globalAlpha = 1;
    }
    this.say();
  }

  say() {
    const any = shared.cursor !== null && this.panels.some(p => p.overTime || p.spec.equal);
    const words = this.panels.map(p => p.words()).filter(Boolean);
    const parts = [];
    if (any && words.length) parts.push(clock(shared.cursor));
    else if (words.length) parts.push(this.panels.filter(p => p.own !== undefined && p.own !== null).map(p => `${p.spec.x.label} ${number(p.own)} ${p.spec.x.unit}`)[0] || '');
    for (const [name, text] of words) parts.push(name + ': ' + text);
    this.readout.textContent = parts.join('  |  ') || 'Drag to zoom, double-click to show all; a click on a name takes it out.';
  }

  // ---- what the user does

  panelAt(x, y) {
    return this.panels.find(p => p.box && x >= p.box.x - 2 && x <= p.box.x + p.box.w + 2 &&
                                 y >= p.box.y - 4 && y <= p.box.y + p.box.h + 4);
  }

  point(event) {
    const r = this.canvas.getBoundingClientRect();
    return [event.clientX - r.left, event.clientY - r.top];
  }

  listen() {
    const c = this.canvas;
    c.addEventListener('pointerdown', e => {
      const [x, y] = this.point(e), panel = this.panelAt(x, y);
      if (!panel || e.button || e.pointerType === 'touch') return;
      this.drag = {x, y, panel, to: [x, y], moved: false};
      c.setPointerCapture(e.pointerId);
    });
    c.addEventListener('pointermove', e => this.move(...this.point(e)));
    c.addEventListener('pointerup', () => this.drop());
    c.addEventListener('pointercancel', () => { this.drag = null, this.paint(); });
    c.addEventListener('pointerleave', () => { if (!this.drag) this.point_at(null, null); });
    c.addEventListener('dblclick', () => this.reset());
    c.addEventListener('keydown', e => this.key(e));
    c.addEventListener('wheel', e => {
      if (!e.ctrlKey) return;
      e.preventDefault();
      const panel = this.panelAt(...this.point(e));
      if (panel) this.scale(e.deltaY > 0 ? 1.25 : 0.8, panel.x.value(this.point(e)[0]), panel);
    }, {passive: false});
  }

  move(x, y) {
    if (this.drag) {
      this.drag.to = [x, y];
      this.drag.moved = Math.hypot(x - this.drag.x, y - this.drag.y) > 5;
      return this.paint();
    }
    const panel = this.panelAt(x, y);
    this.point_at(panel, panel ? panel.x.value(x) : null, panel ? panel.y.value(y) : null);
  }

  point_at(panel, x, y) {
    for (const p of this.panels) p.own = null;
    if (panel && panel.spec.equal) {
      shared.cursor = timeAt(panel, x, y);
    } else if (!panel || panel.overTime) {
      shared.cursor = x;
    } else {
      for (const p of this.panels) if (p.spec.x.label === panel.spec.x.label) p.own = x;
      shared.cursor = null;
    }
    repaint();
  }

  drop() {
    const drag = this.drag;
    this.drag = null;
    if (!drag || !drag.moved) return this.paint();
    const {panel, x, y, to} = drag, sorted = (a, b) => a < b ? [a, b] : [b, a];
    const wide = Math.abs(to[0] - x) > 8, high = Math.abs(to[1] - y) > (panel.spec.equal ? 8 : 30);
    if (wide) this.setX(panel, sorted(panel.x.value(x), panel.x.value(to[0])));
    if (high) panel.zoomY = sorted(panel.y.value(y), panel.y.value(to[1]));
    repaint();
  }

  setX(panel, range) {
    if (panel.overTime) shared.range = range;
    else for (const p of this.panels) if (p === panel || this.spec.share_x) p.zoomX = range;
  }

  scale(factor, centre, only) {
    for (const p of only ? [only] : this.panels.slice(0, this.panels[0].overTime ? 1 : undefined)) {
      const mid = centre !== undefined ? centre : this.at_cursor(p);
      const far = r => p.x.log ? [mid * (r[0] / mid) ** factor, mid * (r[1] / mid) ** factor]
                               : r.map(v => mid + (v - mid) * factor);
      this.setX(p, far([p.x.min, p.x.max]));
      if (p.spec.equal) {
        const m = (p.y.min + p.y.max) / 2;
        p.zoomY = [p.y.min, p.y.max].map(v => m + (v - m) * factor);
      }
    }
    repaint();
  }

  at_cursor(p) {
    const at = p.spec.equal ? null : p.at();
    if (at !== null && at !== undefined && at > p.x.min && at < p.x.max) return at;
    return p.x.log ? Math.sqrt(p.x.min * p.x.max) : (p.x.min + p.x.max) / 2;
  }

  reset() {
    for (const p of this.panels) p.zoomX = p.zoomY = null;
    if (this.panels.some(p => p.overTime)) shared.range = null;
    repaint();
  }

  key(e) {
    const panel = this.panels[0], step = (panel.x.max - panel.x.min) / 100;
    const by = {ArrowLeft: -step, ArrowRight: step}[e.key];
    if (by) {
      const from = panel.at();
      this.point_at(panel, from === null || from === undefined ? (panel.x.min + panel.x.max) / 2
                                                               : from + by);
    } else if (e.key === '+' || e.key === '=') this.scale(0.5);
    else if (e.key === '-') this.scale(2);
    else if (e.key === '0' || e.key === 'Escape') this.reset();
    else return;
    e.preventDefault();
  }
}

// The time at which a track was nearest to a place.
function timeAt(panel, x, y) {
  for (const s of panel.series) {
    if (!s.times || s.hidden || y === undefined) continue;
    let best = null, least = Infinity;
    for (let i = 0; i < s.xs.length; ++i) {
      const d = Math.hypot(s.xs[i] - x, s.ys[i] - y);
      if (d < least) least = d, best = s.times[i];
    }
    return best;
  }
  return null;
}

function repaint() {
  for (const f of figures) if (f.seen) f.paint();
}

for (const element of document.querySelectorAll('figure')) {
  const spec = page.figures[element.id];
  if (spec) figures.push(new Figure(element, spec));
}
addEventListener('resize', repaint);
dark.addEventListener('change', () => {
  for (const f of figures) for (const draw of f.samples) draw();
  repaint();
});
// Folded parts are open on paper.
addEventListener('beforeprint', () => document.querySelectorAll('details').forEach(d => d.open = true));
window.liveReport = {figures, shared, page};
})();
