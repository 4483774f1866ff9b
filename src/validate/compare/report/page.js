
const views = [...document.querySelectorAll('.view')];
let scale = 1, x = 0, y = 0, grip = null;
const apply = () => views.forEach(v => { v.firstElementChild.style.transform = `translate(${x}px,${y}px) scale(${scale})`; });
const fit = () => {
  const v = views[0], i = v.firstElementChild;
  scale = Math.min(v.clientWidth / i.naturalWidth, v.clientHeight / i.naturalHeight); x = y = 0; apply();
};
views.forEach(v => {
  v.addEventListener('wheel', e => {
    e.preventDefault();
    const r = v.getBoundingClientRect(), f = Math.exp(-e.deltaY / 400);
    x = (x - (e.clientX - r.left)) * f + (e.clientX - r.left);
    y = (y - (e.clientY - r.top)) * f + (e.clientY - r.top);
    scale *= f; apply();
  }, { passive: false });
  v.addEventListener('pointerdown', e => { grip = [e.clientX - x, e.clientY - y]; v.setPointerCapture(e.pointerId); e.preventDefault(); });
  v.addEventListener('pointermove', e => { if (grip) { x = e.clientX - grip[0]; y = e.clientY - grip[1]; apply(); } });
  v.addEventListener('pointerup', () => { grip = null; });
  v.addEventListener('dblclick', fit);
});
addEventListener('load', fit);
addEventListener('resize', fit);
