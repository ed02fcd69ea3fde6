// The page of a run: what its address names.

/** What the address names: run.html#state=3&quantity=d_peak&hinge=12. */
function fromAddress() {
  const named = new URLSearchParams(location.hash.slice(1));
  const number = (name, count, otherwise) => {
    const value = named.has(name) ? Number(named.get(name)) : otherwise;
    return Number.isInteger(value) && value >= 0 && value < count ? value : otherwise;
  };
  const quantity = named.get("quantity");
  return {
    state: number("state", stateCount, stateCount - 1),
    hinge: number("hinge", hingeCount, run.worst),
    quantity: Object.hasOwn(quantities, quantity) ? quantity : quantities.d_peak ? "d_peak" : "rotation",
  };
}

/** The number of hinge states of which this page and the run disagree whether they are inside the training domain. */
function domainDisagreements() {
  let count = 0;
  for (let i = 0; run.domain && i < stateCount; i++)
    for (let h = 0; h < hingeCount; h++) {
      const { w_lig, alpha, holes } = run.domain;
      const within = ([low, high], x) => x >= low * (1 - 1e-6) && x <= high * (1 + 1e-6);
      const ligament = within(w_lig, run.hinges.w_lig[h]) && within(alpha, run.hinges.alpha_deg[h] / DEG) && (!holes || within(holes, run.hinges.fillet_ratio[h]));
      const g = ligament ? gaugeOf(i, h) : Infinity;
      if (Math.abs(g - 1) > 1e-5 && (g <= 1) !== (of(states.inside, i, h) === 1)) count += 1;
    }
  return count;
}

take(JSON.parse(byId("run").textContent));
measureExtent();
writeTexts();
writeChoices();
connectControls();
window.addEventListener("hashchange", () => show(fromAddress()));
Object.assign(shownNow, fromAddress());
fitView();
layOut(false);
document.documentElement.dataset.disagreements = domainDisagreements();
document.documentElement.dataset.ready = "true";
