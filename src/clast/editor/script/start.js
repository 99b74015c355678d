/** The beginning of a new case: from a template, from a drawing beside it, or from nothing. */
const { html, render } = htmPreact;

/** Offer the ways to begin in a dialog while the case has no text. */
export async function offerStarts(dialog, { state, hand, ask }) {
  if (state.text.trim() !== "" || state.looks_on) return;
  const begin = async (start) => {
    if (await hand.send("/begin", { text: start })) dialog.close();
    else show();
  };
  let files = [];
  const show = () => render(html`<h2 id="start-head">A new case</h2>
    <p class="help">The file is written as soon as the case has no faults. Esc leaves the text empty.</p>
    <p class="fault" role="alert">${state.refused}</p>
    <p><button onClick=${() => begin("")}>an empty section</button></p>
    ${files.length > 0 && html`<h3>From a drawing beside it</h3><ul>${files.map((file) => html`<li key=${file}><button onClick=${() => begin(file)}>${file}</button></li>`)}</ul>`}
    <h3>From a template</h3><ul>${state.templates.map(({ name, title }) => html`<li key=${name}><button onClick=${() => begin(name)}>${name}</button> ${title}</li>`)}</ul>`, dialog);
  show();
  dialog.showModal();
  ({ files } = await ask("/underlays"));
  files = files.filter((file) => !/\.(png|jpe?g)$/i.test(file));
  show();
}
