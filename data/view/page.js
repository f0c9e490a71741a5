// What all pages of `phyvisgen view` share: the data, and how things are drawn.
"use strict";

const COLORS = ["#2a6fdb", "#d1495b", "#2f9e6e", "#e0912f", "#7b5ea7", "#1b9aaa", "#8d6e63", "#5c7080", "#c2185b", "#7c9a2b"];
const report = JSON.parse(document.getElementById("data").textContent);
const page = document.getElementById("page");

function element(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) name === "text" ? (made.textContent = value) : made.setAttribute(name, value);
  made.append(...children);
  return made;
}
function drawing(tag, attributes = {}, text) {
  const made = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  if (text !== undefined) made.textContent = text;
  return made;
}
// Round numbers (1, 2 or 5 times a power of ten) that cut [low, high] into about n parts; the first and the last enclose it.
function ticks(low, high, n) {
  const rough = (high - low) / n, power = 10 ** Math.floor(Math.log10(rough));
  const step = power * [1, 2, 5, 10].find((factor) => factor * power >= rough * 0.999);
  const first = Math.floor(low / step + 1e-9), last = Math.ceil(high / step - 1e-9);
  return Array.from({ length: last - first + 1 }, (_, i) => +((first + i) * step).toPrecision(12));
}
const counted = (n, one) => `${n} ${one}${n === 1 ? "" : "s"}`;
const short = (x) => (x === 0 ? "0" : Math.abs(x) >= 1000 || Math.abs(x) < 0.001 ? x.toExponential(1) : String(+x.toPrecision(3)));
const percent = (share) => `${(100 * share).toFixed(1)} %`;
