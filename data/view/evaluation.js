// The page of an evaluation: what `evaluate policy --json` printed, with its videos inside.

const { evaluation, file } = report;
const policies = [[evaluation.policy, evaluation], ...Object.entries(evaluation.baselines)];
const round = (x) => Number(x.toPrecision(3)).toString();

function table(heads, rows) {
  const made = element("table", {}, element("tr", {}, ...heads.map((head) => element("th", { text: head }))));
  for (const row of rows) made.append(element("tr", {}, ...row.map((cell) => (cell instanceof Node ? element("td", {}, cell) : element("td", { text: cell })))));
  return made;
}
const card = (...children) => element("div", { class: "card" }, ...children);

// Rates with their intervals: [[label, rate, low, high, text]].
function intervals(rows) {
  const H = 30, left = 150, width = 300, x = (share) => left + width * share;
  const svg = drawing("svg", { viewBox: `0 0 700 ${H * rows.length + 22}`, style: "max-width:860px", role: "img" });
  for (const share of [0, 0.25, 0.5, 0.75, 1]) {
    svg.append(drawing("line", { x1: x(share), x2: x(share), y1: 2, y2: H * rows.length, stroke: "#e3e8ed" }));
    svg.append(drawing("text", { x: x(share), y: H * rows.length + 16, "text-anchor": "middle" }, `${100 * share} %`));
  }
  rows.forEach(([label, rate, low, high, text], i) => {
    const y = H * i + H / 2;
    svg.append(drawing("text", { x: left - 10, y: y + 4, "text-anchor": "end" }, label));
    svg.append(drawing("line", { x1: x(low), x2: x(high), y1: y, y2: y, stroke: COLORS[i % COLORS.length], "stroke-width": 4 }));
    svg.append(drawing("circle", { cx: x(rate), cy: y, r: 6, fill: COLORS[i % COLORS.length] }));
    svg.append(drawing("text", { x: left + width + 12, y: y + 4 }, text));
  });
  return svg;
}

const successes = (result) => result.episodes_detail.filter((episode) => episode.success).length;

function rates() {
  const rows = policies.map(([name, result]) => [name, result.success, result.low, result.high,
    `${successes(result)} of ${result.episodes}, ${percent(result.low)} to ${percent(result.high)}`]);
  const beta = policies.map(([name, result]) => `${name} ${percent(result.beta[0])} to ${percent(result.beta[1])}`).join("; ");
  page.append(element("h2", { text: "Success" }),
    card(intervals(rows), element("p", { class: "quiet", text: `95 % intervals by Wilson. By the posterior of an even prior (Beta): ${beta}.` })));
}

function differences() {
  const rows = Object.entries(evaluation.baselines).map(([name, { policy_above: above }]) =>
    [`above ${name}`, `${percent(above.difference)}`, `${percent(above.low)} to ${percent(above.high)}`, above.gained, above.lost, round(above.p)]);
  if (!rows.length) return;
  page.append(element("h2", { text: "Paired differences, start by start" }),
    card(table([evaluation.policy, "difference", "95 % (Bonett and Price)", "starts gained", "lost", "p (sign test)"], rows)));
}

function events() {
  const names = [...new Set(policies.flatMap(([, result]) => Object.keys(result.events)))].sort();
  if (!names.length) return;
  page.append(element("h2", { text: "Events, in how many episodes" }),
    card(table(["", ...policies.map(([name]) => name)], names.map((name) => [name, ...policies.map(([, result]) => result.events[name] || 0)]))));
}

// Success over an amount: points with intervals, and the task as it is as a dashed line.
function curve({ quantity, points, control }) {
  const W = 520, H = 220, left = 52, right = 16, top = 10, bottom = 40;
  const marks = ticks(points[0].amount, points[points.length - 1].amount, 5);
  const [low, high] = [Math.min(marks[0], points[0].amount), Math.max(marks[marks.length - 1], points[points.length - 1].amount)];
  const x = (amount) => left + ((W - left - right) * (amount - low)) / (high - low), y = (share) => H - bottom - (H - top - bottom) * share;
  const svg = drawing("svg", { viewBox: `0 0 ${W} ${H}`, role: "img" });
  for (const share of [0, 0.25, 0.5, 0.75, 1]) {
    svg.append(drawing("line", { x1: left, x2: W - right, y1: y(share), y2: y(share), stroke: "#e3e8ed" }));
    svg.append(drawing("text", { x: left - 6, y: y(share) + 4, "text-anchor": "end" }, `${100 * share} %`));
  }
  for (const mark of marks) svg.append(drawing("text", { x: x(mark), y: H - bottom + 16, "text-anchor": "middle" }, short(mark)));
  svg.append(drawing("text", { x: (left + W - right) / 2, y: H - 6, "text-anchor": "middle" }, quantity));
  svg.append(drawing("line", { x1: left, x2: W - right, y1: y(evaluation.success), y2: y(evaluation.success), stroke: "#667482", "stroke-dasharray": "5 4" }));
  svg.append(drawing("polyline", { points: points.map((p) => `${x(p.amount)},${y(p.success)}`).join(" "), fill: "none", stroke: COLORS[0], "stroke-width": 1.4 }));
  for (const p of points) {
    svg.append(drawing("line", { x1: x(p.amount), x2: x(p.amount), y1: y(p.low), y2: y(p.high), stroke: COLORS[0], "stroke-width": 3, "stroke-opacity": 0.45 }));
    svg.append(drawing("circle", { cx: x(p.amount), cy: y(p.success), r: 4, fill: COLORS[0] }));
  }
  const says = control.p <= 0.05 ? "success depends on the amount" : "this curve does not show that success depends on the amount";
  const text = `Spread of the rates ${control.spread.toFixed(3)}; of 95 % of curves with shuffled amounts at most ${control.shuffled_spread_95.toFixed(3)}; p = ${round(control.p)}: ${says}.`;
  return element("div", {}, element("h3", { text: `success over ${quantity}; dashed: the task as it is` }), svg, element("p", { class: "quiet", text }));
}

function curves() {
  if (!evaluation.perturbed.length) return;
  const box = element("div", { class: "charts" });
  evaluation.perturbed.forEach((each) => box.append(curve(each)));
  page.append(element("h2", { text: "Success over what the policy does not know of" }), card(box));
}

function videos() {
  if (!report.videos.length) return;
  const row = element("div", { class: "row" });
  for (const video of report.videos) {
    const clip = element("video", { src: video.source, controls: "", muted: "", playsinline: "", preload: "auto" });
    clip.muted = true;
    row.append(element("div", { style: "flex:0 1 360px" }, element("h3", { text: video.name }), clip));
  }
  page.append(element("h2", { text: `Failures of ${evaluation.policy}` }), card(row));
}

function starts() {
  const outcome = (episode) => episode.success ? element("span", { class: "good", text: "success" })
    : element("span", { class: "bad", text: [episode.reason, episode.events.join(", ")].filter(Boolean).join("; ") });
  const rows = evaluation.episodes_detail.map((episode, i) =>
    [episode.seed, ...policies.map(([, result]) => outcome(result.episodes_detail[i])), episode.periods]);
  page.append(element("h2", { text: "Starts" }), card(table(["start", ...policies.map(([name]) => name), "periods"], rows)));
}

document.title = `${evaluation.policy}: ${successes(evaluation)} of ${evaluation.episodes}`;
page.append(element("h1", { text: evaluation.task ? `${evaluation.task}: ${evaluation.policy}` : evaluation.policy }),
  card(element("div", { class: "big", text: `${successes(evaluation)} of ${evaluation.episodes}` }),
    element("span", { class: "quiet", text: `starts that no training has seen; ${file}` })));
rates();
differences();
events();
curves();
videos();
starts();
document.body.dataset.state = "complete";
