/** A refusal of the server, or of the connection (code 0). */
export class RpcError extends Error {
  /** @param {{code?: number, message: string, data?: {field?: string, value?: string,
   *   min?: number, max?: number, allowed?: string[]}}} error */
  constructor({ code = 0, message, data = {} }) {
    super(message);
    this.name = 'RpcError';
    this.code = code;
    this.data = data;
  }
}
