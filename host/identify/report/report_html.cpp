// The report as one self-contained page: sentence, curves, where the misfit is, ranking, notes.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>

#include "host/base/counted.hpp"
#include "host/identify/report/report.hpp"
#include "host/pictures/round_ticks.hpp"

namespace pvg::diagnose {
namespace {

constexpr double WIDTH = 430, HEIGHT = 190, LEFT = 62, RIGHT = 18, BOTTOM = 30, TOP = 24;

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '&' ? "&amp;" : std::string(1, c);
  return out;
}

std::string cell(const std::string& text) { return "<td>" + escaped(text) + "</td>"; }

struct Axis {
  double low = INFINITY, high = -INFINITY;
  void hold(const std::vector<double>& values) {
    for (const double v : values)
      if (std::isfinite(v)) low = std::min(low, v), high = std::max(high, v);
  }
  void widen() {
    if (!(high > low)) low -= 0.5, high += 0.5;
    const double by = 0.05 * (high - low);
    low -= by;
    high += by;
  }
};

std::string path_of(const std::vector<double>& x, const std::vector<double>& y, const Axis& ax, const Axis& ay) {
  std::string d;
  const std::size_t every = std::max<std::size_t>(1, x.size() / 400);
  for (std::size_t i = 0; i < x.size(); i += every) {
    if (!std::isfinite(y[i])) continue;
    char point[60];
    std::snprintf(point, sizeof point, "%c%.1f %.1f", d.empty() ? 'M' : 'L',
                  LEFT + (x[i] - ax.low) / (ax.high - ax.low) * (WIDTH - LEFT - RIGHT),
                  HEIGHT - BOTTOM - (y[i] - ay.low) / (ay.high - ay.low) * (HEIGHT - BOTTOM - TOP));
    d += point;
  }
  return d;
}

std::string text_at(double x, double y, const std::string& anchor, const std::string& text) {
  return "<text x='" + shown(x) + "' y='" + shown(y) + "' text-anchor='" + anchor + "'>" + escaped(text) + "</text>";
}

struct Line {
  const std::vector<double>* y;
  const char* style;
};

// noise: one standard deviation about 0 is shaded; 0: none
std::string plot(const std::string& title, const std::vector<double>& t, const std::vector<Line>& lines,
                 const std::string& unit, double noise = 0) {
  Axis ax, ay;
  ax.hold(t);
  for (const Line& line : lines) ay.hold(*line.y);
  if (noise > 0) ay.hold({-noise, noise});
  if (!(ax.high > ax.low)) ax.high = ax.low + 1;
  ay.widen();
  std::string svg = "<svg viewBox='0 0 " + shown(WIDTH) + " " + shown(HEIGHT) + "'>";
  svg += "<rect x='" + shown(LEFT) + "' y='" + shown(TOP) + "' width='" + shown(WIDTH - LEFT - RIGHT) + "' height='" +
         shown(HEIGHT - BOTTOM - TOP) + "' class='frame'/>";
  const auto column = [&](double v) { return LEFT + (WIDTH - LEFT - RIGHT) * (v - ax.low) / (ax.high - ax.low); };
  const auto row = [&](double v) {
    return HEIGHT - BOTTOM - (HEIGHT - BOTTOM - TOP) * (v - ay.low) / (ay.high - ay.low);
  };
  if (noise > 0)
    svg += "<rect x='" + shown(LEFT) + "' y='" + shown(row(noise)) + "' width='" + shown(WIDTH - LEFT - RIGHT) +
           "' height='" + shown(row(-noise) - row(noise)) + "' class='noise'/>";
  svg += text_at(LEFT, 15, "start", title);
  for (const double v : round_ticks(ay.low, ay.high, 6)) svg += text_at(LEFT - 5, row(v) + 4, "end", shown(v));
  for (const double v : round_ticks(ax.low, ax.high, 5))
    svg += text_at(column(v), HEIGHT - BOTTOM + 14, "middle", shown(v));
  svg += text_at(WIDTH - RIGHT, 15, "end", unit + " over s");
  for (const Line& line : lines) svg += "<path d='" + path_of(t, *line.y, ax, ay) + "' class='" + line.style + "'/>";
  return svg + "</svg>";
}

std::string curves_html(const Diagnosis& d) {
  std::string html;
  for (const Curve& curve : d.curves) {
    std::vector<double> before, after;
    for (std::size_t i = 0; i < curve.t.size(); ++i) {
      before.push_back(curve.measured[i] - curve.before[i]);
      after.push_back(curve.measured[i] - curve.after[i]);
    }
    const std::string title = curve.run + (curve.is_held_out ? ", held out: " : ", fitted: ") + curve.channel;
    html += "<div class='pair'>" +
            plot(title, curve.t, {{&curve.measured, "m"}, {&curve.before, "b"}, {&curve.after, "a"}}, curve.unit) +
            plot("measured less simulated", curve.t, {{&before, "b"}, {&after, "a"}}, curve.unit, curve.sigma) +
            "</div>\n";
  }
  return html;
}

// one row per body, one column per phase, darker where the share of the misfit is larger
std::string map_html(const Diagnosis& d) {
  std::set<std::string> bodies, phases;
  for (const Cell& c : d.where) bodies.insert(c.body), phases.insert(c.phase);
  std::string html = "<table class='map'><tr><th></th>";
  for (const std::string& phase : phases) html += "<th>" + escaped(phase) + "</th>";
  html += "</tr>";
  for (const std::string& body : bodies) {
    html += "<tr><th>" + escaped(body) + "</th>";
    for (const std::string& phase : phases) {
      const auto found = std::find_if(d.where.begin(), d.where.end(),
                                      [&](const Cell& c) { return c.body == body && c.phase == phase; });
      if (found == d.where.end()) {
        html += "<td></td>";
        continue;
      }
      char style[120];
      std::snprintf(style, sizeof style, "<td style='background:rgba(200,60,30,%.2f)'>",
                    found->is_significant ? 0.1 + 0.7 * found->share : 0.0);
      html += style + shown(100 * found->share) + " %<br><small>" + shown(found->rms) + " noise" +
              (found->onset >= 0 ? ", from " + shown(found->onset) + " s" : "") + "</small></td>";
    }
    html += "</tr>";
  }
  return html + "</table>";
}

std::string ranking_html(const Diagnosis& d) {
  if (d.ranking.empty()) return "<p>No effect was compared to its end.</p>";
  std::string html =
      "<table><tr><th>model</th><th>left-out error, times noise</th><th>probability</th><th>values, one standard "
      "deviation</th></tr>";
  for (std::size_t i = 0; i < d.ranking.size() && i < 12; ++i) {
    const RankedModel& model = d.ranking[i];
    std::string name, values;
    std::size_t at = 0;
    for (const Candidate* part : model.parts) {
      name += (name.empty() ? "" : " + ") + part->label();
      for (const Parameter& p : part->parameters) {
        const bool is_known = std::isfinite(model.deviations[at]);
        values += (values.empty() ? "" : ", ") + p.name + " " + shown(model.values[at]) +
                  (is_known ? " ± " + shown(model.deviations[at]) : "") + " " + p.unit;
        ++at;
      }
    }
    if (model.fails_held_out) name += " (fails on held-out runs)";
    html += "<tr>" + cell(name) + cell(shown(model.error)) + cell(shown(model.probability)) + cell(values) + "</tr>";
  }
  return html + "</table>";
}

std::string held_out_text(const Diagnosis& d) {
  if (!(d.floor > 0)) return "There is no held-out error.";  // why: among the notes and what was left out
  return "Held-out error " + shown(d.before) + " before, " + shown(d.after) + " after, noise floor " + shown(d.floor) +
         " " + escaped(d.unit) + "; of the gap " + shown(100 * d.gap_closed) + " % closed.";
}

std::string list_html(const std::vector<std::string>& items) {
  std::string html = "<ul>";
  for (const std::string& item : items) html += "<li>" + escaped(item) + "</li>";
  return html + "</ul>";
}

constexpr const char* STYLE =
    "body{font:15px/1.45 sans-serif;max-width:62em;margin:2em auto;padding:0 "
    "1em;color:#222}h1{font-size:1.25em}h2{font-size:1.05em;"
    "margin-top:1.8em}table{border-collapse:collapse}td,th{border:1px solid #ccc;padding:.25em .6em;text-align:left}"
    ".map td{text-align:center}.pair{display:flex;flex-wrap:wrap}svg{width:30em;max-width:100%}svg text{font-size:10px}"
    ".frame{fill:none;stroke:#bbb}.noise{fill:#777;opacity:.2}path{fill:none;stroke-width:1.3}.m{stroke:#222;stroke-"
    "width:2.2;opacity:.45}.b{"
    "stroke:#c83c1e}"
    ".a{stroke:#1b6fb3}.verdict{font-size:1.15em;border-left:5px solid #1b6fb3;padding:.4em .8em;background:#f2f6fa}";

}  // namespace

std::string html_of(const Problem& problem, const Diagnosis& d) {
  std::string html =
      "<!doctype html><html lang='en'><head><meta charset='utf-8'><meta name='viewport' "
      "content='width=device-width'><title>" +
      escaped(d.sentence) + "</title><style>" + STYLE + "</style></head><body>\n";
  html += "<h1>" + escaped(problem.recording.file.parent_path().filename().string()) + ": " + verdict_name(d.verdict) +
          "</h1>\n<p class='verdict'>" + escaped(d.sentence) + "</p>\n";
  for (const NamedEffect& effect : d.verdict == Verdict::none ? std::vector<NamedEffect>() : d.effects)
    html += "<p>" + escaped(effect.candidate->label()) + ": " + escaped(effect.candidate->meaning) +
            (effect.candidate->equation.empty() ? "" : "; <code>" + escaped(effect.candidate->equation) + "</code>") +
            "</p>";
  html +=
      "<h2>Before and after</h2><p><span style='color:#777'>grey: measured</span>, <span style='color:#c83c1e'>red: "
      "the scene as it was</span>, "
      "<span style='color:#1b6fb3'>blue: with " +
      std::string(d.regressed ? "the law that was regressed" : "what was found") +
      "</span>; shaded: one standard deviation of the noise</p>\n" + curves_html(d);
  html += "<h2>Where</h2><p>Share of the misfit by body and phase of motion, and its size in units of the noise.</p>" +
          map_html(d);
  html += "<h2>What was compared</h2>" + ranking_html(d);
  html += "<h2>What these data cannot tell apart</h2>";
  if (d.inseparable.empty())
    html += d.ranking.empty() ? "<p>Unknown: nothing was compared.</p>" : "<p>Nothing that came near was left.</p>";
  for (const std::vector<std::string>& set : d.inseparable) html += list_html(set);
  if (!d.next_experiment.empty())
    html += "<p>An experiment that separates them: " + escaped(d.next_experiment) + ".</p>";
  html += "<h2>What remains</h2><p>" + held_out_text(d) +
          " Fitting runs, each left out in turn: " + shown(d.fit_before) + " before, " + shown(d.fit_after) +
          " after, in units of noise.</p>";
  if (d.whole.is_judged())
    html += "<p>Held-out runs simulated whole from their first state: error " + shown(d.whole.before) + " before, " +
            shown(d.whole.after) + " after, of the gap " +
            shown(100 * closed(d.whole.before, d.whole.after, d.whole.floor)) + " % closed.</p>";
  if (!d.showable.empty()) {
    std::vector<std::string> rows;
    for (const Showable& row : d.showable) rows.push_back(text_of(row));
    html +=
        "<h2>What these runs could show</h2><p>The smallest size of each that would stand out of the noise, and "
        "beside what mimics it best: computed from the sensitivities, before any fit.</p>" +
        list_html(rows);
  }
  if (!d.left_out.empty()) html += "<h2>Left out for want of time</h2>" + list_html(d.left_out);
  html += "<h2>How it was measured</h2>" + list_html(d.notes) + "<p>" + shown(d.seconds) + " s, " +
          counted(d.simulations, "simulated window") + ".</p></body></html>\n";
  return html;
}

}  // namespace pvg::diagnose
