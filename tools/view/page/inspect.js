// The node that is selected, in words.
function selectAt(x, y) { select(nodeAt(x, y)); }

function select(i) {
  state.selected = i >= 0 && hasNodes() && i < about.nodes.count ? i : -1;
  if (state.selected >= 0 && state.skin === 1 && !state.clip) set("skin", 0.25);
  changed();
}

class InspectLayer {
  update() {
    const i = state.selected, facts = [];
    if (document.activeElement !== $("pick") || i >= 0) $("pick").value = i < 0 ? "" : String(i * about.nodes.step);
    if (i >= 0) {
      for (const name of about.nodes.fields) facts.push([name, short(fieldValues(name)[i])]);
      if (rows) {
        const near = rows[i].filter((e) => isNeighbor(e.bits));
        facts.push(["edges", rows[i].filter((e) => isEdge(e.bits)).length], ["behind a face", near.filter((e) => isBehind(e.bits)).length]);
        if (near.length) facts.push(["farthest", short(near.reduce((m, e) => Math.max(m, e.distance), 0) * about.unit)]);
        const cut = arrays["graph/cut"];
        let lost = 0;
        for (const end of cut) lost += end === i;
        facts.push(["edges cut", lost]);
      }
      if (about.nodes.tree) facts.push(["masters", arrays["tree/node"].reduce((n, x) => n + (x === i + 1), 0)]);
    }
    $("facts").replaceChildren(...facts.flatMap(([name, value]) => {
      const dt = document.createElement("dt"), dd = document.createElement("dd");
      dt.textContent = name, dd.textContent = value;
      return [dt, dd];
    }));
  }
}
