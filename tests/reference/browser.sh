#!/usr/bin/env bash
# The page of compare --html in headless Chromium, without a network: pictures load, the slider and the choices work.
#   browser.sh PROGRAM
set -u
program=$1
browser=$(command -v chromium || command -v chromium-browser || command -v google-chrome) ||
  { echo "no Chromium"; exit 77; }
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1

"$program" compare builtin:square --size 200x150 --reference-samples 16 --frames 1 -t hard -t pcss --no-cache \
  --html page.html || exit 1

# A visitor, put into a copy of the page: does what people do and writes down what it sees.
cat >visitor.html <<'END'
<script>
window.addEventListener('load', () => {
  const seen = [], at = id => document.getElementById(id), say = (what, value) => seen.push(what + '=' + value + ';');
  const set = (id, value) => { at(id).value = value; at(id).dispatchEvent(new Event('input', {bubbles: true})); };
  const images = [...document.images];
  say('images', images.length);
  const loaded = image => image.complete && image.naturalWidth === 200 && image.naturalHeight === 150;
  say('loaded', images.filter(loaded).length);
  say('start', at('left').style.clipPath + ',' + at('bar').style.left);
  say('left-is-truth', at('left').src === at('p0').src);
  say('right-is-best', at('right').src === at('p2').src);
  set('split', 25);
  say('moved', at('left').style.clipPath + ',' + at('bar').style.left);
  set('choose-right', 1);
  say('right-is-hard', at('right').src === at('p1').src);
  const map = document.querySelector('input[value=error]');
  map.checked = true;
  map.dispatchEvent(new Event('input', {bubbles: true}));
  say('right-is-map', at('right').src === at('e1').src);
  const box = at('stage').getBoundingClientRect();
  const to = {buttons: 1, clientX: box.left + 0.75 * box.width, bubbles: true};
  at('stage').dispatchEvent(new PointerEvent('pointermove', to));
  say('dragged', Math.round(parseFloat(at('bar').style.left)));
  say('requests', performance.getEntriesByType('resource').filter(entry => !entry.name.startsWith('data:')).length);
  const out = document.createElement('pre');
  out.id = 'seen';
  out.textContent = seen.join(' ');
  document.body.appendChild(out);
});
</script>
END
cat page.html visitor.html >visited.html

look() { # any request would go to a proxy that is not there
  HOME=$work timeout 100 "$browser" --headless --no-sandbox --disable-gpu --disable-dev-shm-usage \
    --proxy-server=127.0.0.1:9 --user-data-dir="$work/profile" --window-size=1280,1000 --virtual-time-budget=5000 \
    "$@" 2>browser.log
}
look --dump-dom "file://$work/visited.html" >dom.html || { echo "FAILED: the browser: $(tail -3 browser.log)"; exit 1; }
seen=$(grep -o '<pre id="seen">[^<]*' dom.html)
echo "$seen"
status=0
for expected in "images=7;" "loaded=7;" "start=inset(0px 50% 0px 0px),50%;" "left-is-truth=true;" \
  "right-is-best=true;" "moved=inset(0px 75% 0px 0px),25%;" "right-is-hard=true;" "right-is-map=true;" "dragged=75;" \
  "requests=0;"; do
  case $seen in
  *" $expected"* | *">$expected"*) ;;
  *)
    echo "FAILED: not $expected"
    status=1
    ;;
  esac
done
if [ -n "${PENUMBRA_SCREENSHOT:-}" ]; then
  look --screenshot="$PENUMBRA_SCREENSHOT" "file://$work/page.html" >/dev/null
fi
exit $status
