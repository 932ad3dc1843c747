"use strict";
// A bar that is clicked lists trials in it, with the command that shows each.
for (const figure of document.querySelectorAll("figure[data-trials]")) {
  const trials = JSON.parse(document.getElementById(figure.dataset.trials).textContent);
  const place = figure.querySelector(".picked");
  figure.addEventListener("click", (event) => {
    const bar = event.target.closest("rect[data-bar]");
    if (!bar) return;
    const own = trials.bars[bar.dataset.bar] || [];
    place.textContent = bar.querySelector("title").textContent + (own.length ? ". Some of them:" : "");
    for (const trial of own) {
      const code = document.createElement("code");
      code.textContent = `tol3d view ${trials.run} --trial ${trial}`;
      place.append(document.createElement("br"), code);
    }
  });
}
