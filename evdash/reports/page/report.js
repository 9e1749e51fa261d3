/* Draws the report's figures: in the reader's colour scheme, and for paper in black on white. */
(() => {
  "use strict";
  const read = (id) => JSON.parse(document.getElementById(id).textContent);
  const figures = read("data-figures");
  const templates = read("data-templates");
  const dark = window.matchMedia("(prefers-color-scheme: dark)");
  /* Set smaller on paper by the style sheet, so that labels keep their room. */
  const PAPER_PX = { usual: 825, wide: 960 };

  const draw = (scheme, onPaper) => {
    for (const [name, figure] of Object.entries(figures)) {
      const place = document.getElementById(`chart-${name}`);
      const layout = {
        ...structuredClone(figure.layout),
        template: templates[scheme],
        width: onPaper
          ? PAPER_PX[place.classList.contains("wide-chart") ? "wide" : "usual"]
          : place.clientWidth,
      };
      Plotly.react(place, structuredClone(figure.data), layout, {
        displaylogo: false,
        displayModeBar: onPaper ? false : "hover",
      });
    }
  };
  const onScreen = () => draw(dark.matches ? "dark" : "light");

  Plotly.setPlotConfig({ logging: 0 });
  let waiting = 0;
  window.addEventListener("resize", () => {
    clearTimeout(waiting);
    waiting = setTimeout(onScreen, 150);
  });
  dark.addEventListener("change", onScreen);
  window.addEventListener("beforeprint", () => draw("light", true));
  window.addEventListener("afterprint", onScreen);
  onScreen();
})();
