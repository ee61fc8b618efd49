// An episode over the server's binary protocol from JavaScript, without a package.
//
// You learn what a client in any language needs: a WebSocket, MessagePack, and the operations of
// docs/protocol.md. It runs in Node 22 or newer (in Node 20 with --experimental-websocket). Start a
// server first, with `gym-babble serve`, then
//   node examples/server_client.mjs [ws://127.0.0.1:8741] [BabbleReach-v0] [seed]

/** The bytes of a MessagePack: of whole numbers, texts, binaries, lists and maps. */
function pack(value) {
  const big = (code, n) => [code, n >>> 24, (n >>> 16) & 255, (n >>> 8) & 255, n & 255]
  if (typeof value === 'number') return big(0xce, value)
  if (typeof value === 'string') {
    const text = new TextEncoder().encode(value)
    return [...big(0xdb, text.length), ...text]
  }
  if (ArrayBuffer.isView(value)) return [...big(0xc6, value.byteLength), ...new Uint8Array(value.buffer)]
  if (Array.isArray(value)) return [...big(0xdd, value.length), ...value.flatMap(pack)]
  return [...big(0xdf, Object.keys(value).length), ...Object.entries(value).flat().flatMap(pack)]
}

/** The value of a MessagePack: binaries are Uint8Array. */
function unpack(buffer) {
  const view = new DataView(buffer)
  let at = 0
  const take = (n) => (at += n) - n
  const whole = (sign, n) => Number(view[`get${n === 8 ? 'Big' : ''}${sign}${8 * n}`](take(n)))
  const size = (code, first) => whole('Uint', 1 << (code - first))
  const binary = (n) => new Uint8Array(buffer.slice(take(n), at))
  const text = (n) => new TextDecoder().decode(binary(n))
  const list = (n) => Array.from({ length: n }, value)
  const map = (n) => Object.fromEntries(Array.from({ length: n }, () => [value(), value()]))
  function value() {
    const code = whole('Uint', 1)
    if (code < 0x80 || code > 0xdf) return code < 0x80 ? code : code - 256
    if (code < 0xa0) return code < 0x90 ? map(code & 15) : list(code & 15)
    if (code < 0xc0) return text(code & 31)
    if (code < 0xc4) return [null, undefined, false, true][code - 0xc0]
    if (code < 0xc7) return binary(size(code, 0xc4))
    if (code < 0xcc) return code === 0xca ? view.getFloat32(take(4)) : view.getFloat64(take(8))
    if (code < 0xd4) return code < 0xd0 ? size(code, 0xcc) : whole('Int', 1 << (code - 0xd0))
    if (code < 0xdc) return text(size(code, 0xd9))
    return code < 0xde ? list(size(code, 0xdb)) : map(size(code, 0xdd))
  }
  return value()
}

const [url = 'ws://127.0.0.1:8741', env = 'BabbleReach-v0', seed = 0] = process.argv.slice(2)
const socket = new WebSocket(`${url}/ws`, 'gym-babble.v1')
socket.binaryType = 'arraybuffer'
const answer = () =>
  new Promise((resolve, reject) => {
    socket.onopen = resolve
    socket.onmessage = ({ data }) => resolve(unpack(data))
    socket.onclose = ({ reason }) => reject(new Error(`closed ${reason}`))
  })
await answer()

let id = 0
/** The body of the reply to an operation; ids count from 0. */
async function ask(operation, body = {}) {
  socket.send(new Uint8Array(pack([id++, operation, body])))
  const [, result, reply] = await answer()
  if (result === 'error') throw new Error(`${reply.kind}: ${reply.message}`)
  return reply
}

const { spec } = await ask('make', { env, options: { control: 'posture' } })
let { now } = await ask('reset', { seeds: [Number(seed)] })
const actions = new Float32Array(spec.action.labels.length)
let [total, steps] = [0, 0]
for (; !now.terminated[0] && !now.truncated[0]; steps++) {
  ;({ now } = await ask('step', { actions }))
  total += new Float64Array(now.reward.buffer)[0]
}
console.log(`${spec.outcomes[now.outcome[0]]} after ${steps} steps, return ${total}`)
await ask('close')
