// page.html#self-test: uses the page as a reader does and writes what it finds to
// <html data-self-test="…">, for the tests that load it without a screen.

async function self_test() {
  const found = [];
  const expect = (fact, what) => { if (!fact) found.push(what); };
  const next_frame = () => new Promise((done) => setTimeout(done, 30));
  document.querySelectorAll("details").forEach((d) => { d.open = true; });
  // What the observers of widths ask for is drawn at the next picture, and a browser without a
  // screen that is short of time may not come to one: what it owes by then is drawn here.
  const owed = () => [...Chart.all.filter((chart) => !chart.place), ...HeatMap.all.filter((map) => !map.cells)];
  for (let wait = 0; wait < 30 && owed().length; ++wait) await next_frame();
  owed().forEach((drawing) => drawing.draw());
  for (const chart of Chart.all) {
    const name = chart.spec.title;
    const paths = [...chart.plot.querySelectorAll(".curve path")];
    expect(paths.length > 0 && paths.every((p) => p.getAttribute("d").length > 4), `chart "${name}" draws nothing`);
    expect(!/NaN|undefined/.test(chart.plot.outerHTML), `chart "${name}" has NaN in its drawing`);
    const {room, inner, tall} = chart.place;
    chart.show(room.left + inner / 2, room.top + tall / 2);
    expect(!chart.tip.hidden && chart.tip.textContent.length > 0, `chart "${name}" reads nothing out`);
    const before = chart.plot.querySelector(".curve path").getAttribute("d");
    chart.zoom_to(room.left + 0.2 * inner, room.top + 5, room.left + 0.7 * inner, room.top + tall - 5);
    expect(chart.plot.querySelector(".curve path").getAttribute("d") !== before, `chart "${name}" does not zoom`);
    chart.reset();
    expect(chart.plot.querySelector(".curve path").getAttribute("d") === before, `chart "${name}" does not come back from its zoom`);
    const button = chart.legend.querySelector("button");
    if (button && chart.spec.series.length > 1) {
      button.click();
      expect(chart.plot.querySelectorAll(".curve").length === chart.spec.series.length - 1, `chart "${name}" does not hide a curve`);
      button.click();
    }
    chart.tools.x.click();
    chart.tools.x.click();
  }
  for (const map of HeatMap.all) {
    expect(map.cells.length > 0, `map "${map.spec.title}" has no cells`);
    map.show(map.cells[0]);
    expect(!map.tip.hidden, `map "${map.spec.title}" reads nothing out`);
    map.hide();
  }
  for (const player of Player.all) {
    const canvas = player.runs[0].canvas;
    player.seek(0);
    const first = [canvas.toDataURL(), player.clock.textContent];
    player.slider.value = player.times.length - 1;
    player.slider.dispatchEvent(new Event("input"));
    expect(player.times.length < 2 || (canvas.toDataURL() !== first[0] && player.clock.textContent !== first[1]), "the slider does not move the points");
    for (const name of player.names) { player.select.value = name; player.select.dispatchEvent(new Event("change")); }
    player.select.value = player.names[0] ?? "";
    player.select.dispatchEvent(new Event("change"));
    const numbered = player.runs.reduce((n, run) => Math.max(n, run.marks?.probes.length ?? 0), 0);
    expect(player.element.querySelectorAll("p.marks b").length >= numbered, "a probe has no name below the picture");
    if (player.names.includes("body")) {
      expect(player.names[0] === "body" && !player.bodies.hidden && player.scale.hidden, "several bodies are not told apart");
      expect(player.bodies.querySelectorAll("i").length > 1, "the colours of the bodies have no names");
    }
    player.toggle();
    expect(player.times.length < 2 || player.at === 0, "play does not begin anew at the end");
    player.stop();
  }
  expect(document.documentElement.scrollWidth <= window.innerWidth, `the page is ${document.documentElement.scrollWidth} px wide in a window of ${window.innerWidth} px`);
  const counts = `${Chart.all.length} charts, ${HeatMap.all.length} maps, ${Player.all.length} players, ${document.images.length} pictures, ${Player.all.flatMap((p) => p.runs).map((run) => (run.marks ? `${run.marks.surfaces.length} surfaces ${run.marks.probes.length} probes ${run.tracks.length} tracers ${run.marks.lines.length > 0 ? "contours" : "no contours"}` : "points alone")).join(" and ")}`;
  document.documentElement.dataset.selfTest = found.length ? `failed: ${found.join("; ")}` : `passed: ${counts}`;
}
if (location.hash === "#self-test") self_test().catch((error) => { document.documentElement.dataset.selfTest = `failed: ${error.stack}`; });
