// Plays an episode over the binary protocol, without a package, in Node 22 or newer (in Node 20 with
// --experimental-websocket). Start a server first, with `gym-babble serve`, then
//   node examples/server_client.mjs [ws://127.0.0.1:8741] [BabbleReach-v0] [seed]

/** MessagePack of a value: numbers as float64 or, if whole, as uint64. */
function pack(value, bytes = []) {
  const number = (code, size, write) => {
    const view = new DataView(new ArrayBuffer(size))
    write(view)
    bytes.push(code, ...new Uint8Array(view.buffer))
  }
  const length = (code, n) => number(code, 4, (view) => view.setUint32(0, n))
  if (value === null || typeof value === 'boolean') bytes.push({ null: 0xc0, false: 0xc2, true: 0xc3 }[value])
  else if (Number.isSafeInteger(value) && value >= 0) number(0xcf, 8, (view) => view.setBigUint64(0, BigInt(value)))
  else if (typeof value === 'number') number(0xcb, 8, (view) => view.setFloat64(0, value))
  else if (typeof value === 'string') {
    const text = new TextEncoder().encode(value)
    length(0xdb, text.length)
    bytes.push(...text)
  } else if (ArrayBuffer.isView(value)) {
    length(0xc6, value.byteLength)
    bytes.push(...new Uint8Array(value.buffer, value.byteOffset, value.byteLength))
  } else {
    length(Array.isArray(value) ? 0xdd : 0xdf, Object.keys(value).length)
    for (const [name, item] of Object.entries(value)) {
      if (!Array.isArray(value)) pack(name, bytes)
      pack(item, bytes)
    }
  }
  return bytes
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

/** A session; operations and bodies are those of docs/protocol.md. */
class Session {
  static async open(url, make) {
    const session = new Session()
    const socket = (session.socket = new WebSocket(`${url}/ws`, 'gym-babble.v1'))
    socket.binaryType = 'arraybuffer'
    socket.onopen = () => session.resolve()
    socket.onmessage = ({ data }) => session.resolve(unpack(data))
    socket.onclose = ({ reason }) => session.reject(new Error(`closed ${reason}`))
    await session.next()
    session.made = await session.ask('make', make)
    return session
  }

  next() {
    return new Promise((resolve, reject) => Object.assign(this, { resolve, reject }))
  }

  /** The body of the reply; `make` has the id 0, and those that follow grow by one. */
  async ask(operation, body = {}) {
    this.id = (this.id ?? -1) + 1
    this.socket.send(new Uint8Array(pack([this.id, operation, body])))
    const [, result, reply] = await this.next()
    if (result === 'error') throw new Error(`${reply.kind}: ${reply.message}`)
    return reply
  }
}

const [url = 'ws://127.0.0.1:8741', env = 'BabbleReach-v0', seed = 0] = process.argv.slice(2)
const session = await Session.open(url, { env, options: { control: 'posture' } })
const { spec } = session.made
let { now } = await session.ask('reset', { seeds: [Number(seed)] })
const action = new Float32Array(spec.action.labels.length)
let total = 0
let steps = 0
for (; !now.terminated[0] && !now.truncated[0]; steps++) {
  ;({ now } = await session.ask('step', { actions: action }))
  total += new Float64Array(now.reward.buffer)[0]
}
console.log(`${spec.outcomes[now.outcome[0]]} after ${steps} steps, return ${total}`)
await session.ask('close')
