/* The client's own GL loader: a table of function pointers, filled by eglGetProcAddress. Nothing of libepoxy is used
 * here, and the table is the client's alone; the library gets a get_proc_address of its own (gl_address). */
#ifndef HOST_GL_H
#define HOST_GL_H

#include <GL/glcorearb.h>

/* clang-format off */

/* Required of every context of OpenGL 3.3 core. */
#define HOST_GL_FUNCTIONS(X) \
  X(ACTIVETEXTURE, ActiveTexture) X(ATTACHSHADER, AttachShader) X(BEGINQUERY, BeginQuery) \
  X(BINDATTRIBLOCATION, BindAttribLocation) X(BINDBUFFER, BindBuffer) X(BINDBUFFERBASE, BindBufferBase) \
  X(BINDBUFFERRANGE, BindBufferRange) X(BINDFRAMEBUFFER, BindFramebuffer) X(BINDRENDERBUFFER, BindRenderbuffer) \
  X(BINDSAMPLER, BindSampler) X(BINDTEXTURE, BindTexture) X(BINDVERTEXARRAY, BindVertexArray) \
  X(BLENDCOLOR, BlendColor) X(BLENDEQUATIONSEPARATE, BlendEquationSeparate) X(BLENDFUNCSEPARATE, BlendFuncSeparate) \
  X(BLITFRAMEBUFFER, BlitFramebuffer) X(BUFFERDATA, BufferData) X(BUFFERSUBDATA, BufferSubData) \
  X(CHECKFRAMEBUFFERSTATUS, CheckFramebufferStatus) X(CLAMPCOLOR, ClampColor) X(CLEAR, Clear) \
  X(CLEARBUFFERFV, ClearBufferfv) X(CLEARCOLOR, ClearColor) X(CLEARDEPTH, ClearDepth) X(CLEARSTENCIL, ClearStencil) \
  X(COLORMASK, ColorMask) X(COLORMASKI, ColorMaski) X(COMPILESHADER, CompileShader) X(CREATEPROGRAM, CreateProgram) \
  X(CREATESHADER, CreateShader) X(CULLFACE, CullFace) X(DELETEBUFFERS, DeleteBuffers) \
  X(DELETEFRAMEBUFFERS, DeleteFramebuffers) X(DELETEPROGRAM, DeleteProgram) X(DELETEQUERIES, DeleteQueries) \
  X(DELETERENDERBUFFERS, DeleteRenderbuffers) X(DELETESAMPLERS, DeleteSamplers) X(DELETESHADER, DeleteShader) \
  X(DELETETEXTURES, DeleteTextures) X(DELETEVERTEXARRAYS, DeleteVertexArrays) X(DEPTHFUNC, DepthFunc) \
  X(DEPTHMASK, DepthMask) X(DEPTHRANGE, DepthRange) X(DISABLE, Disable) X(DISABLEI, Disablei) \
  X(DRAWARRAYS, DrawArrays) X(DRAWBUFFER, DrawBuffer) X(DRAWBUFFERS, DrawBuffers) X(DRAWELEMENTS, DrawElements) \
  X(ENABLE, Enable) X(ENABLEI, Enablei) X(ENABLEVERTEXATTRIBARRAY, EnableVertexAttribArray) X(ENDQUERY, EndQuery) \
  X(FINISH, Finish) X(FRAMEBUFFERRENDERBUFFER, FramebufferRenderbuffer) \
  X(FRAMEBUFFERTEXTURE2D, FramebufferTexture2D) X(FRAMEBUFFERTEXTURELAYER, FramebufferTextureLayer) \
  X(FRONTFACE, FrontFace) X(GENBUFFERS, GenBuffers) X(GENFRAMEBUFFERS, GenFramebuffers) X(GENQUERIES, GenQueries) \
  X(GENRENDERBUFFERS, GenRenderbuffers) X(GENSAMPLERS, GenSamplers) X(GENTEXTURES, GenTextures) \
  X(GENVERTEXARRAYS, GenVertexArrays) X(GENERATEMIPMAP, GenerateMipmap) X(GETBOOLEANI_V, GetBooleani_v) \
  X(GETERROR, GetError) X(GETFLOATV, GetFloatv) X(GETINTEGER64I_V, GetInteger64i_v) X(GETINTEGERI_V, GetIntegeri_v) \
  X(GETINTEGERV, GetIntegerv) X(GETMULTISAMPLEFV, GetMultisamplefv) X(GETPROGRAMINFOLOG, GetProgramInfoLog) \
  X(GETPROGRAMIV, GetProgramiv) X(GETQUERYIV, GetQueryiv) X(GETQUERYOBJECTUI64V, GetQueryObjectui64v) \
  X(GETQUERYOBJECTUIV, GetQueryObjectuiv) X(GETSHADERINFOLOG, GetShaderInfoLog) X(GETSHADERIV, GetShaderiv) \
  X(GETSTRING, GetString) X(GETSTRINGI, GetStringi) X(GETTEXIMAGE, GetTexImage) \
  X(GETTEXPARAMETERIV, GetTexParameteriv) \
  X(GETUNIFORMBLOCKINDEX, GetUniformBlockIndex) X(GETUNIFORMLOCATION, GetUniformLocation) X(HINT, Hint) \
  X(ISENABLED, IsEnabled) X(ISENABLEDI, IsEnabledi) X(LINEWIDTH, LineWidth) X(LINKPROGRAM, LinkProgram) \
  X(LOGICOP, LogicOp) X(PIXELSTOREI, PixelStorei) X(POINTPARAMETERF, PointParameterf) \
  X(POINTPARAMETERI, PointParameteri) \
  X(POINTSIZE, PointSize) X(POLYGONMODE, PolygonMode) X(POLYGONOFFSET, PolygonOffset) \
  X(PRIMITIVERESTARTINDEX, PrimitiveRestartIndex) X(PROVOKINGVERTEX, ProvokingVertex) X(READBUFFER, ReadBuffer) \
  X(READPIXELS, ReadPixels) X(RENDERBUFFERSTORAGE, RenderbufferStorage) \
  X(RENDERBUFFERSTORAGEMULTISAMPLE, RenderbufferStorageMultisample) X(SAMPLECOVERAGE, SampleCoverage) \
  X(SAMPLEMASKI, SampleMaski) X(SAMPLERPARAMETERI, SamplerParameteri) X(SCISSOR, Scissor) \
  X(SHADERSOURCE, ShaderSource) \
  X(STENCILFUNCSEPARATE, StencilFuncSeparate) X(STENCILMASKSEPARATE, StencilMaskSeparate) \
  X(STENCILOPSEPARATE, StencilOpSeparate) X(TEXBUFFER, TexBuffer) X(TEXIMAGE2D, TexImage2D) \
  X(TEXIMAGE2DMULTISAMPLE, TexImage2DMultisample) X(TEXIMAGE3D, TexImage3D) X(TEXPARAMETERI, TexParameteri) \
  X(UNIFORM1F, Uniform1f) X(UNIFORM1I, Uniform1i) X(UNIFORM3FV, Uniform3fv) \
  X(UNIFORMBLOCKBINDING, UniformBlockBinding) X(UNIFORMMATRIX4FV, UniformMatrix4fv) X(USEPROGRAM, UseProgram) \
  X(VERTEXATTRIBPOINTER, VertexAttribPointer) X(VIEWPORT, Viewport)

/* Newer than the floor: NULL where the context is too old. */
#define HOST_GL_OPTIONAL(X) \
  X(CLIPCONTROL, ClipControl) X(DEBUGMESSAGECALLBACK, DebugMessageCallback) \
  X(DEBUGMESSAGECONTROL, DebugMessageControl) \
  X(BINDIMAGETEXTURE, BindImageTexture) X(BINDPROGRAMPIPELINE, BindProgramPipeline) \
  X(GENPROGRAMPIPELINES, GenProgramPipelines) X(DELETEPROGRAMPIPELINES, DeleteProgramPipelines) \
  X(BINDTRANSFORMFEEDBACK, BindTransformFeedback) X(GENTRANSFORMFEEDBACKS, GenTransformFeedbacks) \
  X(DELETETRANSFORMFEEDBACKS, DeleteTransformFeedbacks) X(BLENDEQUATIONSEPARATEI, BlendEquationSeparatei) \
  X(BLENDFUNCSEPARATEI, BlendFuncSeparatei) X(BINDVERTEXBUFFER, BindVertexBuffer) \
  X(VIEWPORTINDEXEDF, ViewportIndexedf) X(SCISSORINDEXED, ScissorIndexed) X(DEPTHRANGEINDEXED, DepthRangeIndexed) \
  X(GETFLOATI_V, GetFloati_v) X(GETDOUBLEI_V, GetDoublei_v) X(MINSAMPLESHADING, MinSampleShading) \
  X(PATCHPARAMETERI, PatchParameteri) X(PATCHPARAMETERFV, PatchParameterfv) \
  X(GETOBJECTLABEL, GetObjectLabel) X(PUSHDEBUGGROUP, PushDebugGroup) X(POPDEBUGGROUP, PopDebugGroup)

/* clang-format on */

typedef struct {
#define X(upper, name) PFNGL##upper##PROC name;
  HOST_GL_FUNCTIONS(X)
  HOST_GL_OPTIONAL(X)
#undef X
} gl_table;

extern gl_table gl;

/* Fills the table for the current context: 1, or 0 with the missing function's name in *missing. Also listens to the
 * driver's debug messages where it has them. */
int gl_load(const char **missing);

/* Errors since the last call, by debug message and by glGetError; each is printed on stderr. */
int gl_errors(void);

/* The context's version, 33 for 3.3. */
int gl_version(void);
int gl_has(const char *extension);

/* pn_context_desc.get_proc_address. */
void *gl_address(void *user, const char *name);

#endif
